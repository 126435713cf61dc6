/** What the person is told: what was done, what failed and why. */
import { explain } from "../link/failures";
import { Signal } from "./signal";

export interface NewsItem {
  text: string;
  kind: "done" | "failed";
}

export class News {
  readonly latest = new Signal<NewsItem | null>(null);

  done(text: string): void {
    this.latest.set({ text, kind: "done" });
  }

  failed(text: string): void {
    this.latest.set({ text, kind: "failed" });
  }

  /** Waits for what was asked and tells how it went. The answer is null if it failed. */
  async tell<T>(asked: Promise<T>, done: (answer: T) => string | null): Promise<T | null> {
    try {
      const answer = await asked;
      const text = done(answer);
      if (text !== null) this.done(text);
      return answer;
    } catch (error) {
      this.failed(explain(error));
      return null;
    }
  }
}

/** 1 voxel, 2 voxels; 12 345 with a thin gap. */
export function counted(count: number, what: string): string {
  return `${count.toLocaleString("en").replaceAll(",", "\u2009")} ${what}${count === 1 ? "" : "s"}`;
}
