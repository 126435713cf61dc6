/** The layers that this client looks at: asks for them, and again after each connection, and hands frames to their stores. */
import type { Answers, Layer, Requests } from "../../generated/messages";
import type { EventMessage } from "../protocol/envelope";
import type { BlockFrame, ForgetFrame, LabelsFrame } from "../protocol/frames";
import { Signal } from "../base/signal";
import { RefusedError } from "../link/failures";
import { BlockStore } from "./block_store";
import { LabelBlocks } from "./label_blocks";

export type ViewRegion = Pick<Requests["view"], "frame" | "centre" | "radii" | "z">;
export type LookFunction = (body: Requests["view"]) => Promise<Answers["view"]>;
export type CloseFunction = (body: Requests["view_close"]) => Promise<unknown>;

const kMapStream = 0;
/** After a start the server does not know yet what it will: who labels, which agents there are. */
const kMayCome = new Set(["UNAVAILABLE", "NO_AGENT", "NO_MAP", "BUSY", "TIMEOUT", "RATE"]);
const kAgainMs = 2000;
export type Later = (task: () => void, ms: number) => unknown;

export class LayerView {
  readonly store = new BlockStore();
  readonly labels = new LabelBlocks();
  /** Whether all that is in view is here. */
  readonly complete = new Signal(false);
  readonly failure = new Signal<string | null>(null);
  stream: number | null = null;
  region: ViewRegion | null = null;
  private asking = false;
  private again = false;

  constructor(
    readonly layer: Layer,
    readonly agent: string | undefined,
    private readonly look: LookFunction,
    private readonly close: CloseFunction,
    private readonly later: Later,
  ) {}

  /** Looks there from now on. While an answer is awaited the newest region waits. */
  show(region: ViewRegion): void {
    this.region = region;
    if (this.asking) {
      this.again = true;
      return;
    }
    this.ask();
  }

  hide(): void {
    this.region = null;
    if (this.stream !== null) this.close({ stream: this.stream }).catch(() => {}); // closed by then, or with the connection
    this.stream = null;
    this.clear();
  }

  /** A connection began. */
  renew(keep: boolean): void {
    if (!keep) this.clear();
    this.stream = null;
    this.asking = false;
    if (this.region) this.ask();
  }

  apply(frame: BlockFrame | ForgetFrame | LabelsFrame): void {
    if (this.layer === "labels") {
      if (frame.kind !== "block") this.labels.apply(frame);
    } else if (frame.kind !== "labels") {
      this.store.apply(frame);
    }
    this.complete.set(false);
  }

  clear(): void {
    this.store.clear();
    this.labels.clear();
    this.complete.set(false);
  }

  private ask(): void {
    const region = this.region!;
    this.asking = true;
    this.again = false;
    this.look({ layer: this.layer, ...(this.agent === undefined ? {} : { agent: this.agent }), ...region })
      .then(({ stream }) => {
        this.stream = stream;
        this.failure.set(null);
        if (!this.region) this.hide();
      })
      .catch((error: unknown) => this.failed(error))
      .finally(() => {
        this.asking = false;
        if (this.again && this.region) this.ask();
      });
  }

  private failed(error: unknown): void {
    this.failure.set(error instanceof Error ? error.message : String(error));
    if (!(error instanceof RefusedError) || !kMayCome.has(error.refusal.code)) return;
    this.later(() => {
      if (this.region && this.stream === null && !this.asking) this.ask();
    }, kAgainMs);
  }
}

export class Views {
  private readonly views = new Set<LayerView>();

  constructor(
    private readonly look: LookFunction,
    private readonly close: CloseFunction,
    private readonly later: Later = (task, ms) => setTimeout(task, ms),
  ) {}

  open(layer: Layer, agent?: string): LayerView {
    const view = new LayerView(layer, agent, this.look, this.close, this.later);
    this.views.add(view);
    return view;
  }

  drop(view: LayerView): void {
    view.hide();
    this.views.delete(view);
  }

  /** @param keep whether blocks of the map's stream are still good */
  renew(keep: boolean): void {
    for (const view of this.views) view.renew(keep && view.stream === kMapStream);
  }

  hear(message: EventMessage): void {
    if (message.event === "epoch") this.find(message.body.stream)?.clear();
    if (message.event === "complete") this.find(message.body.stream)?.complete.set(true);
  }

  apply(frame: BlockFrame | ForgetFrame | LabelsFrame): void {
    this.find(frame.stream)?.apply(frame);
  }

  private find(stream: number): LayerView | undefined {
    for (const view of this.views) {
      if (view.stream === stream) return view;
    }
    return undefined;
  }
}
