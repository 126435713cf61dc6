/** What the server last said of who and what is there. */
import type { Agent, Events, Lease, Path, Person, Role, RobotPose, Zone } from "../../generated/messages";
import type { EventMessage } from "../protocol/envelope";
import { Signal } from "../base/signal";

export type Detection = Events["detection"];
export type Slip = Events["alignment"];

export class World {
  readonly role = new Signal<Role>("view");
  readonly agents = new Signal<Agent[]>([]);
  readonly poses = new Signal<RobotPose[]>([]);
  readonly people = new Signal<Person[]>([]);
  readonly zones = new Signal<Zone[]>([]);
  readonly leases = new Signal<Lease[]>([]);
  /** Processes of the stack that were heard since this connection began, and are silent now. */
  readonly silent = new Signal<string[]>([]);
  /** Of robots whose path is followed. */
  readonly paths = new Signal<ReadonlyMap<string, Path>>(new Map());
  /** Those that nobody has decided on. */
  readonly detections = new Signal<Detection[]>([]);
  /** Agents that seem to have slipped. */
  readonly slips = new Signal<Slip[]>([]);
  /** Blocks that wait at the server because this client is slow. */
  readonly lacking = new Signal<number>(0);

  /** The agent that this device is; none on a desk. */
  own: string | null = null;

  private heard: string[] = [];

  private hearProcesses(alive: string[]): void {
    this.heard = [...new Set([...this.heard, ...alive])];
    this.silent.set(this.heard.filter((process) => !alive.includes(process)));
  }

  agent(name: string): Agent | undefined {
    return this.agents.value.find(({ agent }) => agent === name);
  }

  /** Those that can be sent somewhere. */
  robots(): Agent[] {
    return this.agents.value.filter(({ agent, type }) => type !== "headset" && type !== "map" && agent !== this.own);
  }

  /** A connection began: what was decided meanwhile is not said any more, what is open comes again. */
  renew(): void {
    this.heard = [];
    this.silent.set([]);
    this.detections.set([]);
    this.slips.set([]);
  }

  setPath(path: Path): void {
    this.paths.set(new Map(this.paths.value).set(path.robot, path));
  }

  dropPath(robot: string): void {
    const paths = new Map(this.paths.value);
    paths.delete(robot);
    this.paths.set(paths);
  }

  hear(message: EventMessage): void {
    switch (message.event) {
      case "agents":
        return this.agents.set(message.body.agents);
      case "poses":
        return this.poses.set(message.body.poses);
      case "people":
        return this.people.set(message.body.people);
      case "zones":
        return this.zones.set(message.body.zones);
      case "leases":
        return this.leases.set(message.body.leases);
      case "processes":
        return this.hearProcesses(message.body.alive);
      case "path":
        return this.setPath(message.body.path);
      case "behind":
        return this.lacking.set(message.body.lacking);
      case "complete":
        return this.lacking.set(0);
      case "detection": {
        const others = this.detections.value.filter(({ detection }) => detection !== message.body.detection);
        return this.detections.set(message.body.open ? [...others, message.body] : others);
      }
      case "alignment": {
        const others = this.slips.value.filter(({ agent }) => agent !== message.body.agent);
        return this.slips.set(message.body.open ? [...others, message.body] : others);
      }
      case "epoch":
      case "bad":
      case "bye":
        return; // the views' and the link's
    }
  }
}
