/** Places where agents disagree, as asked for last, looked at one after the other. */
import type { ConflictRegion } from "../../generated/messages";
import { counted, type News } from "../base/news";
import { Signal } from "../base/signal";
import type { Vec3 } from "../base/vec";
import type { Ask } from "../link/link";

export interface Conflicts {
  /** Those with the most voxels first. */
  regions: ConflictRegion[];
  /** In all, also in regions that are not among these. */
  voxels: number;
  /** Which of the regions is looked at. */
  at: number | null;
}

const kMost = 20;

export class ConflictTour {
  readonly found = new Signal<Conflicts | null>(null);

  constructor(
    private readonly ask: Ask,
    private readonly news: News,
  ) {}

  get region(): ConflictRegion | undefined {
    const { value } = this.found;
    return value?.regions[value.at ?? -1];
  }

  async refresh(): Promise<void> {
    const answer = await this.news.tell(this.ask("conflicts", { most: kMost }), () => null);
    if (answer) this.found.set({ regions: answer.regions, voxels: answer.voxels_in_all, at: null });
  }

  /** The next place, or the one before; round and round. */
  step(by: 1 | -1): void {
    const { value } = this.found;
    if (!value || value.regions.length === 0) return;
    const { length } = value.regions;
    this.look(value.at === null ? (by > 0 ? 0 : length - 1) : (value.at + by + length) % length);
  }

  look(at: number | null): void {
    const { value } = this.found;
    if (value) this.found.set({ ...value, at });
  }
}

/** Its lowest and highest corner in the map. */
export function cornersOf({ low, high }: ConflictRegion, resolution: number): [Vec3, Vec3] {
  return [low.map((c) => c * resolution) as Vec3, high.map((c) => (c + 1) * resolution) as Vec3];
}

export function conflictWords({ voxels, claims }: ConflictRegion): string {
  return `${counted(voxels, "voxel")}. ${claims.map(({ agent, occupied, free }) => `${agent}: ${occupied} occupied, ${free} free`).join("; ")}`;
}
