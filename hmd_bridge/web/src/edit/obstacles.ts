/** Virtual obstacles that this page added: whoever put one there can take it away again, after a reload too. */
import { kept, type Store } from "../base/kept";
import type { News } from "../base/news";
import type { Signal } from "../base/signal";
import type { Ask } from "../link/link";
import type { Editor } from "./editor";

const isTexts = (value: unknown): value is readonly string[] => Array.isArray(value) && value.every((each) => typeof each === "string");

export class Obstacles {
  /** Their ids. */
  readonly own: Signal<readonly string[]>;

  constructor(
    private readonly ask: Ask,
    private readonly editor: Editor,
    private readonly news: News,
    store: Store,
  ) {
    this.own = kept(store, "concord-obstacles", [], isTexts);
  }

  async add(): Promise<void> {
    const answer = await this.editor.obstacle();
    if (answer) this.own.set([...this.own.value, answer.obstacle]);
  }

  async remove(obstacle: string): Promise<void> {
    if (await this.news.tell(this.ask("obstacle_remove", { obstacle }), () => "The obstacle is gone.")) this.drop(obstacle);
  }

  /** Drops those that were taken away without this page, as by an undo in the history; where that cannot be asked they stay. */
  async check(): Promise<void> {
    for (const obstacle of this.own.value) {
      const answer = await this.ask("history", { subject: obstacle, most: 1000 }).catch(() => null);
      if (answer && !answer.operations.some(({ operation, active }) => operation === obstacle && active)) this.drop(obstacle);
    }
  }

  private drop(obstacle: string): void {
    this.own.set(this.own.value.filter((other) => other !== obstacle));
  }
}
