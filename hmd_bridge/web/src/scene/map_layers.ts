/** The layers that can be looked at, which of them are shown, and how finely. */
import { Group } from "three";
import type { Layer } from "../../generated/messages";
import type { World } from "../link/world";
import { distance, kIdentity, type Vec3 } from "../base/vec";
import { Signal } from "../base/signal";
import type { DetailBudget } from "../map/level_of_detail";
import { nextRadii } from "../map/level_of_detail";
import type { Mesher } from "../map/mesher";
import { raycast, type VoxelHit } from "../map/raycast";
import type { LayerView, Views } from "../map/views";
import { BlockLayer } from "./block_layer";
import { kAsset, kConflict, kGridFree, kGridOccupied, kManualLabel, colourOf } from "./colours";
import type { MapRay, Stage } from "./stage";
import { place } from "./three_pose";
import type { VoxelStyle } from "./voxel_material";

export const kLayers: readonly { layer: Layer; title: string; shown: boolean }[] = [
  { layer: "map", title: "Map", shown: true },
  { layer: "labels", title: "Labels and assets", shown: true },
  { layer: "conflicts", title: "Conflicts", shown: false },
  { layer: "grid_occupied", title: "2D grid, blocked", shown: false },
  { layer: "grid_free", title: "2D grid, free", shown: false },
];

const kStyles: Record<Layer, VoxelStyle> = {
  map: { tint: null, opacity: 1, over: false },
  labels: { tint: kManualLabel, opacity: 1, over: true },
  conflicts: { tint: kConflict, opacity: 1, over: true },
  grid_occupied: { tint: kGridOccupied, opacity: 0.9, over: true },
  grid_free: { tint: kGridFree, opacity: 0.5, over: true },
  agent: { tint: null, opacity: 0.65, over: false },
};

const kReach = 200;
const kMoveShare = 0.15;
const kCheckSeconds = 0.5;

/** One layer that is looked at, with what draws it. */
interface Shown {
  view: LayerView;
  layers: BlockLayer[];
  group: Group;
}

export class MapLayers {
  readonly group = new Group();
  /** By layer, or by "agent NAME". */
  readonly shown = new Map<string, Shown>();
  readonly clip = new Signal<[number, number] | null>(null);
  readonly changed = new Signal(0);
  private radii: number[];
  private centre: Vec3 = [0, 0, 0];
  private sinceCheck = 0;

  constructor(
    private readonly views: Views,
    private readonly mesher: Mesher,
    private readonly stage: Stage,
    private readonly world: World,
    readonly resolution: number,
    private readonly budget: DetailBudget,
  ) {
    this.radii = budget.radii;
    stage.onFrame.add((seconds) => this.tick(seconds));
    for (const { layer, shown } of kLayers) if (shown) this.show(layer);
    world.agents.onChange(() => this.placeAgents());
    this.clip.onChange(() => {
      this.style();
      this.lookAgain();
    });
  }

  get triangles(): number {
    let sum = 0;
    for (const { layers } of this.shown.values()) for (const layer of layers) sum += layer.triangles;
    return sum;
  }

  /** Whether all in view is here and drawn. */
  get settled(): boolean {
    return this.mesher.settled && [...this.shown.values()].every(({ view }) => view.complete.value || view.failure.value !== null);
  }

  get mapView(): LayerView | undefined {
    return this.shown.get("map")?.view;
  }

  isShown(layer: Layer, agent?: string): boolean {
    return this.shown.has(nameOf(layer, agent));
  }

  show(layer: Layer, agent?: string): void {
    const name = nameOf(layer, agent);
    if (this.shown.has(name)) return;
    const view = this.views.open(layer, agent);
    const group = new Group();
    const style = agent === undefined ? kStyles[layer] : { ...kStyles[layer], tint: colourOf(agent) };
    const drawn = (): void => this.stage.invalidate();
    const add = (store: LayerView["store"], more: VoxelStyle): BlockLayer => new BlockLayer(store, this.mesher, this.resolution, more, this.stage.mapFromWorld, drawn);
    const layers = layer === "labels" ? [add(view.labels.manual, style), add(view.labels.assets, { ...style, tint: kAsset })] : [add(view.store, style)];
    for (const each of layers) group.add(each.group);
    this.group.add(group);
    this.shown.set(name, { view, layers, group });
    view.complete.onChange((complete) => {
      if (complete && layer === "map") this.style();
    });
    this.placeAgents();
    this.style();
    this.look(view);
    this.changed.set(this.changed.value + 1);
  }

  hide(layer: Layer, agent?: string): void {
    const name = nameOf(layer, agent);
    const shown = this.shown.get(name);
    if (!shown) return;
    this.views.drop(shown.view);
    for (const layerDrawn of shown.layers) layerDrawn.dispose();
    shown.group.removeFromParent();
    this.shown.delete(name);
    this.stage.invalidate();
    this.changed.set(this.changed.value + 1);
  }

  /** Where detail is wanted, in the map. */
  setCentre(p: Vec3): void {
    if (distance(p, this.centre) < this.radii[0]! * kMoveShare) return;
    this.centre = p;
    this.lookAgain();
  }

  /** The first voxel of the map, or of what is labelled, that a ray meets. */
  pick(ray: MapRay): VoxelHit | null {
    const store = this.mapView?.store;
    if (!store || store.size === 0) return null;
    const [low, high] = this.clip.value ?? [-Infinity, Infinity];
    const inClip = (z: number): boolean => (z + 1) * this.resolution > low && z * this.resolution < high;
    return raycast((voxel) => inClip(voxel[2]) && store.occupied(voxel), ray.origin, ray.direction, this.resolution, kReach);
  }

  private lookAgain(): void {
    for (const { view } of this.shown.values()) this.look(view);
  }

  private look(view: LayerView): void {
    const flat = view.layer === "grid_free" || view.layer === "grid_occupied" || view.layer === "labels";
    const radii = flat ? [this.radii.at(-1)!] : this.radii;
    const z = this.clip.value && view.layer !== "agent" && !flat ? { z: this.clip.value } : {};
    view.show({ frame: "map", centre: this.centre, radii: view.layer === "agent" ? [this.budget.radii.at(-1)! * 4] : radii, ...z });
  }

  private tick(seconds: number): void {
    for (const { layers } of this.shown.values()) for (const layer of layers) layer.update();
    this.sinceCheck += seconds;
    if (this.sinceCheck < kCheckSeconds || !this.settled) return;
    this.sinceCheck = 0;
    const radii = nextRadii(this.budget, this.radii, this.triangles);
    if (radii.some((radius, i) => radius !== this.radii[i])) {
      this.radii = radii;
      this.lookAgain();
    }
  }

  /** An agent's own layer lies where the agent does; one that is in no map at the origin. */
  private placeAgents(): void {
    for (const { view, group } of this.shown.values()) {
      if (view.agent !== undefined) place(group, this.world.agent(view.agent)?.T_map_agent ?? kIdentity);
    }
    this.stage.invalidate();
  }

  private style(): void {
    const bounds = this.mapView?.store.bounds();
    for (const { layers } of this.shown.values()) {
      for (const { material } of layers) {
        const { clip, heights } = material.uniforms as { clip: { value: { set(a: number, b: number): void } }; heights: { value: { set(a: number, b: number): void } } };
        clip.value.set(...(this.clip.value ?? [-1e9, 1e9]));
        if (bounds) heights.value.set(bounds.low[2] * this.resolution, Math.min(bounds.high[2] * this.resolution, bounds.low[2] * this.resolution + 4));
      }
    }
    this.stage.invalidate();
  }
}

const nameOf = (layer: Layer, agent: string | undefined): string => (agent === undefined ? layer : `agent ${agent}`);
