/**
 * Get Scene and Send Scene: a person takes what is around them, prepares changes in peace, and sends them all at once; the
 * server refuses them where somebody else changed something meanwhile.
 */
import { checkStruct, type Requests, type SceneEdit, type SceneZone } from "../../generated/messages";
import { kept, type Store } from "../base/kept";
import { counted, type News } from "../base/news";
import type { Signal } from "../base/signal";
import type { Vec3 } from "../base/vec";
import { sayRefusal } from "../link/failures";
import type { Ask } from "../link/link";

export interface Draft {
  revision: number;
  voxelBoxes: number;
  edits: SceneEdit[];
  zones: SceneZone[];
  /** In which order they were prepared. */
  steps: ("edit" | "zone")[];
  /** Changes of this scene that were sent before, or may have been. */
  known: string[];
}

const kMost = 64;

function isDraft(value: unknown): value is Draft {
  if (typeof value !== "object" || value === null) return false;
  const { revision, voxelBoxes, edits, zones, steps, known } = value as Partial<Record<keyof Draft, unknown>>;
  const all = (list: unknown, struct: string): boolean => Array.isArray(list) && list.length <= kMost && list.every((each) => checkStruct(struct, each) === null);
  const ordered = (list: unknown, step: string): number => (Array.isArray(list) ? list.filter((each) => each === step).length : -1);
  return Number.isSafeInteger(revision) && Number.isSafeInteger(voxelBoxes) && all(edits, "SceneEdit") && all(zones, "SceneZone")
    && Array.isArray(known) && known.length <= kMost && known.every((each) => typeof each === "string")
    && ordered(steps, "edit") === (edits as unknown[]).length && ordered(steps, "zone") === (zones as unknown[]).length;
}

export class SceneDraft {
  readonly open: Signal<Draft | null>;

  constructor(
    private readonly ask: Ask,
    private readonly news: News,
    store: Store,
  ) {
    this.open = kept<Draft | null>(store, "concord-scene", null, isDraft);
  }

  async get(centre: Vec3, radius: number): Promise<void> {
    const asked = this.ask("scene_get", { frame: "map", centre, radius });
    const scene = await this.news.tell(asked, ({ voxels, zones }) => `Scene taken: ${counted(voxels.boxes.length, "block")} of voxels, ${counted(zones.length, "zone")}. Your edits wait until Send Scene.`);
    if (scene) this.open.set({ revision: scene.revision, voxelBoxes: scene.voxels.boxes.length, edits: [], zones: [], steps: [], known: [] });
  }

  addEdit(edit: SceneEdit): void {
    const draft = this.open.value;
    if (draft && draft.edits.length < kMost) this.open.set({ ...draft, edits: [...draft.edits, edit], steps: [...draft.steps, "edit"] });
  }

  addZone(zone: SceneZone): void {
    const draft = this.open.value;
    if (draft && draft.zones.length < kMost) this.open.set({ ...draft, zones: [...draft.zones, zone], steps: [...draft.steps, "zone"] });
  }

  async send(): Promise<void> {
    const draft = this.open.value;
    if (!draft) return this.news.failed("There is no scene to send. Get Scene takes the one around you.");
    const body: Requests["scene_send"] = { base_revision: draft.revision, frame: "map", edits: draft.edits, zones: draft.zones, known: draft.known };
    const asked = this.ask("scene_send", body);
    const answer = await this.news.tell(asked, ({ edits, zones, stopped }) => (stopped ? null : `Scene sent: ${counted(edits.length, "change")}, ${counted(zones, "zone")}.`));
    if (!answer) return;
    for (const edit of answer.edits) this.onSent(edit);
    if (!answer.stopped) return this.open.set(null);
    const edits = draft.edits.slice(answer.edits.length);
    const zones = draft.zones.slice(answer.zones);
    const known = [...draft.known, ...answer.edits, ...(answer.unsure === undefined ? [] : [answer.unsure])].slice(-kMost);
    this.open.set({ ...draft, edits, zones, known, steps: [...edits.map(() => "edit" as const), ...zones.map(() => "zone" as const)] });
    this.news.failed(`${sayRefusal(answer.stopped)} What came before it is done; the rest waits for Send Scene.`);
  }

  /** A change of it is done, and can be undone by this id. */
  onSent: (edit: string) => void = () => {};

  /** Takes back the change that was prepared last. @return whether there was one */
  takeBack(): boolean {
    const draft = this.open.value;
    const last = draft?.steps.at(-1);
    if (!draft || !last) return false;
    const steps = draft.steps.slice(0, -1);
    this.open.set(last === "edit" ? { ...draft, steps, edits: draft.edits.slice(0, -1) } : { ...draft, steps, zones: draft.zones.slice(0, -1) });
    return true;
  }

  discard(): void {
    this.open.set(null);
  }
}
