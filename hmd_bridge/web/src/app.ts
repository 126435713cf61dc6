/** Everything that the views of one map share, on a desk and in a headset. */
import { Group } from "three";
import type { HelloAnswer, Instance, Pose } from "../generated/messages";
import { News } from "./base/news";
import { Signal } from "./base/signal";
import { fromYaw, kIdentity, type Vec3 } from "./base/vec";
import { AlignSession } from "./edit/align_session";
import { keptTurnAt } from "./edit/asset_pose";
import { ConflictTour } from "./edit/conflict_tour";
import { Editor } from "./edit/editor";
import { Obstacles } from "./edit/obstacles";
import { pathWords } from "./edit/robot_acts";
import { SceneDraft } from "./edit/scene_draft";
import type { Ask, Link } from "./link/link";
import type { World } from "./link/world";
import type { DetailBudget } from "./map/level_of_detail";
import { Mesher } from "./map/mesher";
import { Views } from "./map/views";
import { EditOverlay } from "./scene/edit_overlay";
import { GridSheet } from "./scene/grid_sheet";
import { MapLayers } from "./scene/map_layers";
import type { Stage } from "./scene/stage";
import { WorldOverlay } from "./scene/world_overlay";

const kMostInstances = 1000;
const kSceneRadius = 10;

export interface Eyes {
  /** Where this person is, in the map. */
  here(): Vec3;
  /** Shows them a box of the map. */
  lookAt(low: Vec3, high: Vec3): void;
}

export class App {
  readonly ask: Ask;
  readonly draft: SceneDraft;
  readonly obstacles: Obstacles;
  readonly editor: Editor;
  readonly align: AlignSession;
  readonly conflicts: ConflictTour;
  readonly layers: MapLayers;
  readonly editOverlay: EditOverlay;
  readonly grid: GridSheet;
  readonly things = new Signal<Instance[]>([]);
  private readonly views: Views;
  private readonly own: Signal<HelloAnswer>;

  constructor(
    readonly link: Link,
    readonly world: World,
    readonly stage: Stage,
    readonly news: News,
    hello: HelloAnswer,
    budget: DetailBudget,
    workers: Worker[],
  ) {
    this.own = new Signal(hello);
    this.ask = (name, body) => link.request(name, body);
    this.draft = new SceneDraft(this.ask, news, sessionStorage);
    this.editor = new Editor(this.ask, news, this.draft);
    this.obstacles = new Obstacles(this.ask, this.editor, news, localStorage);
    this.editor.setThickness(hello.resolution);
    this.align = new AlignSession(this.ask, (agent, resolution) => this.minimap(agent, resolution), news);
    this.conflicts = new ConflictTour(this.ask, news);
    this.views = new Views((body) => link.request("view", body), (body) => link.request("view_close", body));
    link.onBlocks = (frame) => this.views.apply(frame);
    link.onEvent = (message) => {
      this.world.hear(message);
      this.views.hear(message);
    };
    const content = new Group();
    stage.map.add(content);
    this.layers = new MapLayers(this.views, new Mesher(workers), stage, world, hello.resolution, budget);
    const drawn = (): void => stage.invalidate();
    this.editOverlay = new EditOverlay(this.editor, this.draft, this.align, (target) => this.targetPose(target), hello.resolution, drawn);
    this.grid = new GridSheet(hello.resolution, stage.renderer.capabilities.maxTextureSize, drawn);
    content.add(this.layers.group, this.grid.group, new WorldOverlay(world, this.conflicts, hello.resolution, drawn).group, this.editOverlay.group);
    this.layers.changed.watch(() => {
      this.watchLabels();
      if (!this.layers.isShown("conflicts")) this.conflicts.look(null);
    });
    void this.obstacles.check();
  }

  get hello(): HelloAnswer {
    return this.own.value;
  }

  get mayEdit(): boolean {
    return this.world.role.value !== "view";
  }

  get mayDrive(): boolean {
    return this.world.role.value === "robot";
  }

  /** A connection began. @param keep whether blocks of the map are still good */
  renew(hello: HelloAnswer, keep: boolean): void {
    this.own.set(hello);
    this.world.renew();
    this.views.renew(keep);
    for (const robot of this.world.paths.value.keys()) void this.followPath(robot, true);
    void this.obstacles.check();
  }

  async followPath(robot: string, follow: boolean): Promise<void> {
    if (!follow) this.world.dropPath(robot);
    const answer = await this.news.tell(this.ask("path", { robot, frame: "map", follow }), ({ path }) =>
      follow && path.points.length === 0 ? `${robot}: ${pathWords(path)}` : null);
    if (answer && follow) this.world.setPath(answer.path);
  }

  async loadThings(): Promise<void> {
    const answer = await this.news.tell(this.ask("instances", { most: kMostInstances }), () => null);
    if (!answer) return;
    // A list that is drawn anew takes the buttons away under the hand that is about to press one.
    if (JSON.stringify(answer.instances) !== JSON.stringify(this.things.value)) this.things.set(answer.instances);
    this.layers.shown.get("labels")?.view.labels.setAssets(answer.instances.filter(({ asset }) => asset !== undefined));
    this.stage.invalidate();
  }

  /** Takes a labelled thing away: its voxels too, unless they are kept. */
  async removeThing({ label, instance, class_name }: Instance, keep: boolean): Promise<void> {
    const asked = this.ask("instance_delete", { label, instance, keep_voxels: keep });
    await this.changed(asked, ({ voxels }) => `${class_name} ${instance} is gone${keep ? ", its voxels stay" : `: ${voxels} voxels`}.`);
  }

  async reassign({ label, instance, class_name }: Instance, other: string): Promise<void> {
    const asked = this.ask("instance_reassign", { label, instance, class_name: other });
    await this.changed(asked, (now) => `${class_name} ${instance} is ${other} ${now.instance} now.`);
  }

  async putAsset(asset: string, class_name: string, yaw: number): Promise<void> {
    const position = await this.editor.askPoint(`Click where the ${class_name} shall stand.`);
    if (!position) return;
    const asked = this.ask("asset_add", { asset, frame: "map", T_frame_asset: { position, rotation: fromYaw(yaw) } });
    await this.changed(asked, ({ instance, voxels }) => `${class_name} ${instance}: ${voxels} voxels.`);
  }

  async moveAsset(thing: Instance): Promise<void> {
    const { label, instance, class_name } = thing;
    const position = await this.editor.askPoint(`Click where ${class_name} ${instance} shall stand.`);
    if (!position) return;
    await this.loadThings();  // somebody may have turned it meanwhile
    const now = this.things.value.find((one) => one.label === label && one.instance === instance) ?? thing;
    const asked = this.ask("asset_move", { label, instance, frame: "map", T_frame_asset: keptTurnAt(now, position) });
    await this.changed(asked, () => `${class_name} ${instance} was moved.`);
  }

  async removeAsset({ label, instance, class_name }: Instance): Promise<void> {
    if (await this.news.tell(this.ask("asset_delete", { label, instance }), () => `${class_name} ${instance} is gone.`)) await this.loadThings();
  }

  /** What was seen is there: it is put into the map. */
  async confirm(detection: string): Promise<void> {
    await this.changed(this.ask("detection_confirm", { detection }), ({ message }) => message);
  }

  /** The labelled thing at a point of the map, or beside it within half a voxel. */
  thingAt(p: Vec3): Instance | null {
    const labels = this.layers.shown.get("labels")?.view.labels;
    const r = this.layers.resolution;
    const steps: Vec3[] = [[0, 0, 0], [0, 0, -1], [0, 0, 1], [-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0]];
    for (const step of steps) {
      const found = labels?.at(p.map((c, i) => Math.floor(c / r + step[i]! / 2)) as Vec3);
      const thing = found && this.things.value.find(({ label, instance }) => label === found.label && instance === found.instance);
      if (thing) return thing;
    }
    return null;
  }

  /** Labels or assets were changed, if it was granted: that can be undone, and the list of things is another. */
  private async changed<T extends { undo: string }>(asked: Promise<T>, words: (answer: T) => string): Promise<void> {
    const answer = await this.news.tell(asked, words);
    if (!answer) return;
    this.editor.did(answer.undo);
    await this.loadThings();
  }

  /** Asks where agents disagree, and shows it. */
  async showConflicts(): Promise<void> {
    this.layers.show("conflicts");
    await this.conflicts.refresh();
  }

  async sendMap(): Promise<void> {
    await this.news.tell(this.ask("send_map", { final: false }), ({ occupied }) => `Your map was sent: ${occupied} voxels.`);
  }

  async getScene(): Promise<void> {
    await this.draft.get(this.eyes.here(), kSceneRadius);
  }

  /** Whose eyes these are: the desk's or the headset's. */
  eyes: Eyes = { here: () => [0, 0, 0], lookAt: () => {} };

  private targetPose(target: string | undefined): Pose | null {
    return target === undefined ? kIdentity : (this.world.agent(target)?.T_map_agent ?? null);
  }

  private async minimap(agent: string, resolution: number): ReturnType<ConstructorParameters<typeof AlignSession>[1]> {
    return (await this.link.requestFrame("minimap", { agent, resolution }, "points")).frame;
  }

  private readonly watched = new WeakSet<object>();
  /** Which things are assets is asked for whenever the labels have changed. */
  private watchLabels(): void {
    const view = this.layers.shown.get("labels")?.view;
    if (!view || this.watched.has(view)) return;
    this.watched.add(view);
    view.complete.onChange((complete) => {
      if (complete) void this.loadThings();
    });
  }
}
