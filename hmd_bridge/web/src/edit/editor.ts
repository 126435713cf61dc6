/** The person's selection and what is done with it; undo and redo; the lease while they work. */
import type { EditOp, Requests, Answers, Shape, Volume, ZoneKind } from "../../generated/messages";
import { counted, type News } from "../base/news";
import type { Ask } from "../link/link";
import { Signal } from "../base/signal";
import { sub, type Vec3 } from "../base/vec";
import { begun, boundsOf, ended, shapeOf, volumeOf, withoutLast, withPoint, type Selection, type Tool } from "./selection";
import type { SceneDraft } from "./scene_draft";

const kLease = "selection";
const kLeaseMs = 5000;
const kLeaseMargin = 0.1;

export class Editor {
  readonly selection = new Signal<Selection | null>(null);
  /** Why nothing can be changed now; null if it can. */
  readonly blocked = new Signal<string | null>(null);
  /** Somebody waits for one point: of the map, or of the room about a device that has no place in the map. */
  readonly question = new Signal<{ hint: string; unplaced: boolean; answer: (p: Vec3 | null) => void } | null>(null);
  readonly height = new Signal<number | null>(2);
  readonly thickness = new Signal(0.05);
  readonly undoable = new Signal<readonly string[]>([]);
  readonly redoable = new Signal<readonly string[]>([]);
  private leased = false;

  constructor(
    private readonly ask: Ask,
    private readonly news: News,
    private readonly draft: SceneDraft,
  ) {
    this.selection.onChange(() => this.lease());
    this.draft.onSent = (edit) => this.did(edit);
    setInterval(() => this.lease(), kLeaseMs);
    // Where this device lost its place, what it shows is another point of the map than the person means.
    this.blocked.onChange((why) => {
      const open = this.question.value;
      if (why === null || !open || open.unplaced) return;
      this.question.set(null);
      open.answer(null);
      this.news.failed(why);
    });
  }

  begin(tool: Tool): void {
    this.selection.set(begun(tool, this.thickness.value, this.height.value));
  }

  /** The next point of what is being selected, or the answer to what was asked. */
  point(p: Vec3): void {
    const question = this.question.value;
    if (question) {
      this.question.set(null);
      question.answer(p);
      return;
    }
    const selection = this.selection.value;
    if (selection) this.selection.set(withPoint(selection, p));
  }

  end(): void {
    if (this.selection.value) this.selection.set(ended(this.selection.value));
  }

  back(): void {
    const selection = this.selection.value;
    if (!selection) return;
    this.selection.set(selection.points.length > 0 ? withoutLast(selection) : null);
  }

  cancel(): void {
    this.question.value?.answer(null);
    this.question.set(null);
    this.selection.set(null);
  }

  setHeight(height: number | null): void {
    this.height.set(height);
    if (this.selection.value) this.selection.set({ ...this.selection.value, height });
  }

  setThickness(thickness: number): void {
    this.thickness.set(thickness);
    if (this.selection.value) this.selection.set({ ...this.selection.value, thickness });
  }

  /** A point of the map that the person shows; null if they would rather not, or cannot. @param unplaced whether it is asked where this device has no place in the map, too */
  askPoint(hint: string, unplaced = false): Promise<Vec3 | null> {
    this.cancel();
    if (!unplaced && !this.permitted()) return Promise.resolve(null);
    return new Promise((answer) => this.question.set({ hint, unplaced, answer }));
  }

  /** @param move metres, for op move */
  async apply(op: EditOp, move?: Vec3): Promise<void> {
    const shape = this.shape();
    if (!shape) return;
    if (this.draft.open.value && op !== "move") {
      this.draft.addEdit({ op, shape });
      this.cancel();
      return this.news.done("Added to your scene. Send Scene sends it to everybody.");
    }
    const body: Requests["edit"] = { op, frame: "map", shape, ...(move ? { move } : {}) };
    const words = { add: "added", delete: "cleared", move: "moved" }[op];
    const answer = await this.news.tell(this.ask("edit", body), ({ voxels }) => `${counted(voxels, "voxel")} ${words}.`);
    if (!answer) return;
    this.did(answer.edit);
    this.cancel();
  }

  /** Moves what is selected: the person shows a point of it, and where that shall go. */
  async move(): Promise<void> {
    const selection = this.selection.value;
    if (!this.shape()) return;
    const from = await this.askPoint("Click a point of what shall move.");
    const to = from && (await this.askPoint("Click where that point shall go."));
    if (!to) return;
    this.selection.set(selection);
    await this.apply("move", sub(to, from));
  }

  /** Something was done that can be undone by this id. */
  did(undo: string): void {
    this.undoable.set([...this.undoable.value, undo]);
    this.redoable.set([]);
  }

  /** Whether this person did something that is not undone yet. */
  get canUndo(): boolean {
    return this.undoable.value.length > 0 || (this.draft.open.value?.steps.length ?? 0) > 0;
  }

  async undo(): Promise<void> {
    // What is not sent yet was done last, as far as the person is concerned.
    if (this.draft.takeBack()) return this.news.done("The last change of your scene is taken back; the others wait for Send Scene.");
    const edit = this.undoable.value.at(-1);
    if (edit === undefined) return this.news.failed("You have nothing to undo. Others' changes are in History.");
    if (!(await this.news.tell(this.ask("undo", { edit }), () => "Undone."))) return;
    this.undoable.set(this.undoable.value.filter((other) => other !== edit));
    this.redoable.set([...this.redoable.value, edit]);
  }

  async redo(): Promise<void> {
    const edit = this.redoable.value.at(-1);
    if (edit === undefined) return this.news.failed("There is nothing to redo.");
    if (!(await this.news.tell(this.ask("redo", { edit }), () => "Done again."))) return;
    this.redoable.set(this.redoable.value.filter((other) => other !== edit));
    this.undoable.set([...this.undoable.value, edit]);
  }

  async label(className: string): Promise<void> {
    const shape = this.shape();
    if (!shape) return;
    const asked = this.ask("label", { frame: "map", shape, class_name: className });
    const answer = await this.news.tell(asked, ({ voxels, instance }) => `${counted(voxels, "voxel")} labelled as ${className} ${instance}.`);
    if (!answer) return;
    this.did(answer.undo);
    this.cancel();
  }

  /** One touch: the thing at a point that the person shows. @param name asked for once they have shown it */
  async touch(name: () => Promise<string | null>): Promise<void> {
    if (!this.permitted()) return;
    const p = await this.askPoint("Click the thing that you want to name.");
    const class_name = p && (await name());
    if (!p || !class_name) return;
    const asked = this.ask("label_touch", { frame: "map", p, class_name });
    const answer = await this.news.tell(asked, ({ voxels, instance }) => `${class_name} ${instance}: ${counted(voxels, "voxel")}. Undo it if that is not the thing.`);
    if (answer) this.did(answer.undo);
  }

  async zone(name: string, kind: ZoneKind): Promise<void> {
    const volume = this.volume();
    if (!volume) return;
    if (this.draft.open.value) {
      this.draft.addZone({ name, zone_kind: kind, volume });
      this.cancel();
      return this.news.done("The zone was added to your scene.");
    }
    const asked = this.ask("zone_add", { name, zone_kind: kind, frame: "map", volume });
    if (await this.news.tell(asked, () => `Zone ${name} added.`)) this.cancel();
  }

  /** Gives a zone the selected volume. @param revision that it was seen at */
  async reshapeZone(name: string, kind: ZoneKind, revision: number): Promise<void> {
    const volume = this.volume();
    if (!volume) return;
    const asked = this.ask("zone_change", { name, zone_kind: kind, frame: "map", volume, base_revision: revision });
    if (await this.news.tell(asked, () => `Zone ${name} has another shape.`)) this.cancel();
  }

  async obstacle(): Promise<Answers["obstacle_add"] | null> {
    const volume = this.volume();
    if (!volume) return null;
    const answer = await this.news.tell(this.ask("obstacle_add", { frame: "map", volume }), ({ paths }) => {
      const other = paths.filter(({ replanned }) => replanned).map(({ robot }) => robot);
      return other.length > 0 ? `Obstacle added; another way for ${other.join(", ")}.` : "Obstacle added; no path crossed it.";
    });
    if (answer) this.cancel();
    return answer;
  }

  private shape(): Shape | null {
    const shape = this.selection.value && shapeOf(this.selection.value);
    if (!shape) this.news.failed("Select something first: take a tool and click its points.");
    return this.permitted() ? shape : null;
  }

  private volume(): Volume | null {
    const volume = this.selection.value && volumeOf(this.selection.value);
    if (!volume) this.news.failed("Select a box or a prism first.");
    return this.permitted() ? volume : null;
  }

  private permitted(): boolean {
    if (this.blocked.value !== null) this.news.failed(this.blocked.value);
    return this.blocked.value === null;
  }

  /** Keeps others out of where this person works; that it could not be had is told when they apply something. */
  private lease(): void {
    const shape = this.selection.value && shapeOf(this.selection.value);
    const volume = shape && boundsOf(shape, kLeaseMargin);
    if (volume && this.blocked.value === null) {
      this.leased = true;
      this.ask("lease_hold", { lease: kLease, frame: "map", volume }).catch(() => {});
    } else if (this.leased) {
      this.leased = false;
      this.ask("lease_free", { lease: kLease }).catch(() => {});
    }
  }
}
