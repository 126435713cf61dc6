/** What a person asks of one robot, by showing places of the map. */
import type { Path } from "../../generated/messages";
import type { App } from "../app";
import { fromYaw, type Vec3 } from "../base/vec";

/** The planner's message says what else there is to know, also of a path that is there: why, that its map is old. */
export function pathWords({ status, message, length, clearance, plan_number, active, seconds, zones, failed_leg, nearest }: Path): string {
  if (status !== "OK") {
    const leg = failed_leg === undefined || failed_leg === 0 ? "" : `; leg ${failed_leg + 1} cannot be gone`;
    return `No path (${status})${message && `: ${message}`}${leg}${nearest ? "; the nearest place it can reach is marked" : ""}`;
  }
  const time = seconds === undefined ? "" : `, ${duration(seconds)}`;
  const times = plan_number > 1 ? `, planned ${plan_number} times` : "";
  const away = zones.length > 0 ? `, keeps away from ${zones.join(", ")}` : "";
  return `${length.toFixed(1)} m${time}, at least ${clearance.toFixed(2)} m of room${times}${away}${active ? "" : ", a plan only"}${message && `; ${message}`}`;
}

export function duration(seconds: number): string {
  const whole = Math.round(seconds);
  return whole < 60 ? `${whole} s` : `${Math.floor(whole / 60)} min ${whole % 60} s`;
}

export async function whatIf(app: App, robot: string): Promise<void> {
  const goal = await app.editor.askPoint(`Click where ${robot} would go.`);
  if (!goal) return;
  const answer = await app.news.tell(app.ask("plan", { robot, frame: "map", goal }), ({ path }) => pathWords(path));
  if (answer) app.world.setPath(answer.path);
}

export async function send(app: App, robot: string): Promise<void> {
  const goal = await app.editor.askPoint(`Click where ${robot} shall go.`);
  if (!goal) return;
  const T_frame_goal = { position: goal, rotation: fromYaw(0) };
  const answer = await app.news.tell(app.ask("goal", { robot, frame: "map", T_frame_goal }), ({ path }) => `${robot}${path.status === "OK" ? " is on its way" : ""}: ${pathWords(path)}`);
  if (answer) app.world.setPath(answer.path);
}

/** The person shows where they see a robot; from that their device finds where it is. @param toOwn from the map to the device's own frame */
export async function refer(app: App, robot: string, toOwn: (p: Vec3) => Vec3): Promise<void> {
  const at = await app.editor.askPoint(`Click where you see ${robot}.`, true);
  const ahead = at && (await app.editor.askPoint(`Click a place straight ahead of ${robot}.`, true));
  if (!ahead) return;
  const [from, to] = [toOwn(at), toOwn(ahead)];
  await app.align.refer(robot, { position: from, rotation: fromYaw(Math.atan2(to[1] - from[1], to[0] - from[0])) });
}

export async function correct(app: App, robot: string): Promise<void> {
  const at = await app.editor.askPoint(`Click where ${robot} really stands.`);
  const ahead = at && (await app.editor.askPoint(`Click a place straight ahead of ${robot}.`));
  if (!ahead) return;
  const T_frame_base = { position: at, rotation: fromYaw(Math.atan2(ahead[1] - at[1], ahead[0] - at[0])) };
  const utime = app.link.clock.utime(Date.now());
  await app.news.tell(app.ask("robot_correct", { robot, frame: "map", T_frame_base, utime }), () => `${robot} is placed there, and its map with it.`);
}

