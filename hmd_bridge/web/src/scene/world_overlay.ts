/** Draws who and what is there besides voxels: robots, people, zones, leases, paths, detections. In the map's frame. */
import { ConeGeometry, CylinderGeometry, Group, Mesh, MeshBasicMaterial, Object3D, SphereGeometry, TorusGeometry } from "three";
import type { ConflictRegion, Path, Person, RobotPose } from "../../generated/messages";
import type { Vec3 } from "../base/vec";
import { cornersOf, type ConflictTour } from "../edit/conflict_tour";
import { duration } from "../edit/robot_acts";
import type { World } from "../link/world";
import type { Signal } from "../base/signal";
import { kAllowContact, kAsset, kConflict, kLease, kNoGo, colourOf } from "./colours";
import { discard, edgesObject, nameSprite, pathObject, shapeObject } from "./shapes";
import { place } from "./three_pose";

export class WorldOverlay {
  readonly group = new Group();

  constructor(
    world: World,
    conflicts: ConflictTour,
    private readonly resolution: number,
    private readonly drawn: () => void,
  ) {
    this.redraw(world.poses, (poses) => poses.filter(({ agent }) => agent !== world.own).map(robotObject));
    this.redraw(world.people, (people) => people.flatMap(personObjects));
    this.redraw(world.zones, (zones) =>
      zones.map((zone) => this.placed(zone.T_map_zone, shapeObject(zone.volume, this.resolution, zone.zone_kind === "no_go" ? kNoGo : kAllowContact, 0.16))));
    this.redraw(world.leases, (leases) => leases.map((lease) => this.placed(lease.T_map_lease, shapeObject(lease.volume, this.resolution, kLease, 0.05))));
    this.redraw(world.paths, (paths) => [...paths.values()].flatMap(pathObjects));
    this.redraw(conflicts.found, () => (conflicts.region ? [conflictObject(conflicts.region, this.resolution)] : []));
    this.redraw(world.detections, (detections) =>
      detections.map((detection) => {
        const object = nameSprite(`${detection.class_name}?`, kAsset, 0.22);
        object.position.set(...detection.T_map_object.position);
        return object;
      }));
  }

  private placed<T extends Object3D>(T: Parameters<typeof place>[1], object: T): T {
    place(object, T);
    return object;
  }

  private redraw<T>(signal: Signal<T>, make: (value: T) => Object3D[]): void {
    const group = new Group();
    this.group.add(group);
    signal.watch((value) => {
      for (const child of [...group.children]) discard(child);
      for (const object of make(value)) group.add(object);
      this.drawn();
    });
  }
}

/** The place that is looked at; its voxels are a layer. */
function conflictObject(region: ConflictRegion, resolution: number): Object3D {
  const [min, max] = cornersOf(region, resolution);
  return shapeObject({ kind: "box", min, max }, resolution, kConflict, 0.1);
}

/** The way and how long it takes; or, where there is none, how far the robot gets. */
export function pathObjects(path: Path): Object3D[] {
  const { points, seconds, nearest, robot } = path;
  const colour = colourOf(robot);
  const end = points.at(-1);
  if (!end) return nearest ? [reachObject(nearest, colour), raised(nameSprite(`${robot} gets as far as here`, colour, 0.18), nearest)] : [];
  if (points.length < 2) return [];
  return [pathObject(path), ...(seconds === undefined ? [] : [raised(nameSprite(duration(seconds), colour, 0.18), end.p)])];
}

function raised<T extends Object3D>(object: T, [x, y, z]: Vec3): T {
  object.position.set(x, y, z + 0.4);
  return object;
}

function reachObject(p: Vec3, colour: number): Object3D {
  const ring = new Mesh(new TorusGeometry(0.2, 0.03, 8, 32), new MeshBasicMaterial({ color: colour }));
  ring.position.set(...p);
  return ring;
}

function robotObject({ agent, T_map_base, stale }: RobotPose): Object3D {
  const colour = colourOf(agent);
  const group = new Group();
  const material = new MeshBasicMaterial({ color: colour, transparent: stale, opacity: stale ? 0.4 : 1 });
  const body = new Mesh(new CylinderGeometry(0.22, 0.26, 0.3, 24), material);
  body.rotation.x = Math.PI / 2;
  body.position.z = 0.18;
  const nose = new Mesh(new ConeGeometry(0.12, 0.3, 20), material);
  nose.rotation.z = -Math.PI / 2;
  nose.position.set(0.36, 0, 0.18);
  const name = nameSprite(stale ? `${agent} (silent)` : agent, colour, 0.26);
  name.position.z = 0.75;
  group.add(body, nose, name);
  place(group, T_map_base);
  return group;
}

function personObjects({ person, name, device, T_map_head, p_map_pointer }: Person): Object3D[] {
  const colour = colourOf(`${name}${person}`);
  const objects: Object3D[] = [];
  if (T_map_head) {
    const group = new Group();
    group.add(new Mesh(new SphereGeometry(0.11, 20, 14), new MeshBasicMaterial({ color: colour })));
    const label = nameSprite(name || device, colour, 0.18);
    label.position.z = 0.28;
    group.add(label);
    place(group, T_map_head);
    // Names stand above heads whichever way those look.
    label.position.applyQuaternion(group.quaternion.clone().invert());
    objects.push(group);
  }
  if (p_map_pointer) {
    const cursor = new Mesh(new SphereGeometry(0.045, 14, 10), new MeshBasicMaterial({ color: colour, depthTest: false, transparent: true }));
    cursor.position.set(...p_map_pointer);
    cursor.renderOrder = 11;
    objects.push(cursor);
    if (T_map_head) objects.push(edgesObject([[T_map_head.position, p_map_pointer]], colour));
  }
  return objects;
}
