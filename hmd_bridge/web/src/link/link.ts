/**
 * The connection to the bridge: requests and their answers, events, frames, credit, and coming back after it was lost.
 * Messages are taken strictly in the order in which they came, so what depends on order can rely on it.
 */
import { VERSION, type Answers, type Code, type Events, type HelloAnswer, type HelloRequest, type Notices, type Requests } from "../../generated/messages";
import { answerTo, readText, TextError, type EventMessage, type ServerText } from "../protocol/envelope";
import { FrameError, readFrame, type CellsFrame, type PointsFrame, type ServerFrame } from "../protocol/frames";
import { Signal } from "../base/signal";
import { ServerClock } from "./clock";
import { explain, RefusedError } from "./failures";

/** What this needs of a WebSocket. */
export interface Socket {
  binaryType: string;
  readonly readyState: number;
  onopen: (() => void) | null;
  onclose: (() => void) | null;
  onmessage: ((event: { data: string | ArrayBuffer }) => void) | null;
  send(data: string | Uint8Array<ArrayBuffer>): void;
  close(code?: number): void;
}

export interface LinkOptions {
  open: () => Socket;
  /** A ticket for one connection; undefined where none is needed. Rejects where it cannot be had. */
  ticket: () => Promise<string | undefined>;
  who: () => Pick<HelloRequest, "name" | "device" | "agent" | "frame_id">;
  /** Milliseconds. */
  now: () => number;
  later: (milliseconds: number, what: () => void) => void;
}

export type LinkState =
  | { state: "connecting" }
  | { state: "ready"; hello: HelloAnswer }
  | { state: "lost"; why: string; seconds: number }
  | { state: "refused"; why: string; code: Code | null };

/** As Link.request(). */
export type Ask = <K extends keyof Requests>(name: K, body: Requests[K]) => Promise<Answers[K]>;

type AskedFrame = PointsFrame | CellsFrame;
interface Pending {
  name: keyof Answers;
  data: string | Uint8Array<ArrayBuffer>;
  frame?: AskedFrame;
  /** It changes what of the map is looked at. */
  looks: boolean;
  resolve: (result: { fields: unknown; frame: AskedFrame | undefined }) => void;
  reject: (error: Error) => void;
}

const kOpen = 1;
/** Of the codes for applications: browsers let pages send no other but 1000. */
const kNotTaken = 4002;
const kCreditAhead = 4_000_000;
const kCheckMs = 10_000;
const kSilentMs = 25_000;
const kMaxWaitSeconds = 10;

const kMapStream = 0;
function looksElsewhere(name: keyof Requests, body: Requests[keyof Requests]): boolean {
  return name === "view" ? (body as Requests["view"]).layer === "map" : name === "view_close" && (body as Requests["view_close"]).stream === kMapStream;
}

export class Link {
  readonly state = new Signal<LinkState>({ state: "connecting" });
  readonly clock = new ServerClock();
  /** Told of each connection: `keep` says whether blocks of stream 0 are still good. */
  onReady: (hello: HelloAnswer, keep: boolean) => void = () => {};
  onEvent: (message: EventMessage) => void = () => {};
  onBlocks: (frame: Exclude<ServerFrame, AskedFrame>) => void = () => {};

  private socket: Socket | null = null;
  private hello: HelloAnswer | null = null;
  /** What the server says it knows to be here of the map; null from a view of it on until that is complete. */
  private lastComplete: { epoch: string; revision: number } | null = null;
  private lastId = 0;
  private readonly pending = new Map<number, Pending>();
  private taking: Promise<void> = Promise.resolve();
  private taken = 0;
  private granted = 0;
  private heardAt = 0;
  private tries = 0;
  private ended = false;
  private bye: string | null = null;

  constructor(private readonly options: LinkOptions) {}

  connect(): void {
    this.ended = false;
    this.state.set({ state: "connecting" });
    this.options.ticket().then(
      (ticket) => this.open(ticket),
      (error: unknown) => this.refused(error),
    );
  }

  /** For good; requests that wait are rejected. */
  close(): void {
    this.ended = true;
    this.socket?.close(1000);
    this.abandon("The page closed the connection.");
  }

  /** Rejects with RefusedError, or Error where the connection was lost for good. */
  async request<K extends keyof Requests>(name: K, body: Requests[K]): Promise<Answers[K]> {
    return (await this.asked(name, body)).answer;
  }

  /** As request(), with the frame that came before the answer. Rejects if it was lost with a connection. */
  async requestFrame<K extends keyof Requests, F extends AskedFrame["kind"]>(name: K, body: Requests[K], kind: F): Promise<{ answer: Answers[K]; frame: AskedFrame & { kind: F } }> {
    const { answer, frame } = await this.asked(name, body);
    if (frame?.kind !== kind) throw new Error("What was asked for was lost on its way. Ask again.");
    return { answer, frame: frame as AskedFrame & { kind: F } };
  }

  private async asked<K extends keyof Requests>(name: K, body: Requests[K]): Promise<{ answer: Answers[K]; frame: AskedFrame | undefined }> {
    const id = ++this.lastId;
    const { fields, frame } = await this.ask(id, name, JSON.stringify({ id, request: name, body }), looksElsewhere(name, body));
    return { answer: answerTo(name, fields), frame };
  }

  /** Sends a mesh frame that `make` makes for its id. */
  async upload(make: (id: number) => Uint8Array<ArrayBuffer>): Promise<Answers["upload_mesh"]> {
    const id = ++this.lastId;
    const { fields } = await this.ask(id, "upload_mesh", make(id));
    return answerTo("upload_mesh", fields);
  }

  /** Not answered, and not kept for later while there is no connection. */
  notice<K extends keyof Notices>(name: K, body: Notices[K]): void {
    const { socket } = this;
    if (this.state.value.state === "ready" && socket?.readyState === kOpen) socket.send(JSON.stringify({ notice: name, body }));
  }

  private ask(id: number, name: keyof Answers, data: Pending["data"], looks = false): ReturnType<typeof this.wait> {
    if (looks) this.lastComplete = null; // also without a connection: the first view of the next one is another
    if (this.state.value.state !== "ready") return Promise.reject(new Error("There is no connection to the server now."));
    const answered = this.wait(id, name, data, looks);
    this.socket?.send(data);
    return answered;
  }

  private wait(id: number, name: keyof Answers, data: Pending["data"], looks = false): Promise<{ fields: unknown; frame: AskedFrame | undefined }> {
    return new Promise((resolve, reject) => this.pending.set(id, { name, data, looks, resolve, reject }));
  }

  private open(ticket: string | undefined): void {
    if (this.ended) return;
    const socket = this.options.open();
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.taken = 0;
    this.granted = 0;
    this.bye = null;
    this.taking = Promise.resolve();
    socket.onopen = () => this.sayHello(socket, ticket);
    socket.onmessage = ({ data }) => {
      this.heardAt = this.options.now();
      this.taking = this.taking.then(() => (this.socket === socket ? this.take(data) : undefined));
    };
    socket.onclose = () => {
      void this.taking.then(() => this.closed(socket));
    };
  }

  private sayHello(socket: Socket, ticket: string | undefined): void {
    const id = ++this.lastId;
    const body: HelloRequest = { version: VERSION, ...this.options.who() };
    if (ticket !== undefined) body.ticket = ticket;
    if (this.hello) {
      const { epoch, revision } = this.lastComplete ?? { epoch: "", revision: 0 }; // of no epoch: nothing is held
      body.resume = { session: this.hello.session, epoch, revision };
    }
    this.wait(id, "hello", "")
      .then(({ fields }) => this.welcome(answerTo("hello", fields)))
      .catch((error: unknown) => this.refused(error));
    socket.send(JSON.stringify({ id, request: "hello", body }));
  }

  private welcome(hello: HelloAnswer): void {
    const sameEpoch = this.lastComplete?.epoch === hello.epoch;
    this.hello = hello;
    if (!hello.resumed) this.abandon("The connection was lost; the server may have done this all the same: see History.");
    this.state.set({ state: "ready", hello });
    this.grant();
    for (const { data } of this.pending.values()) this.socket?.send(data);
    this.onReady(hello, hello.resumed && sameEpoch);
    this.heardAt = this.options.now();
    this.check(this.socket);
  }

  /** Rejects what waits for an answer that will not come. */
  private abandon(why: string): void {
    const pending = [...this.pending.values()];
    this.pending.clear();
    for (const { reject } of pending) reject(new Error(why));
  }

  private refused(error: unknown): void {
    const why = error instanceof Error ? error.message : String(error);
    const again = error instanceof RefusedError ? error.refusal.retry : !this.ended;
    if (again) {
      this.retry(why);
      return;
    }
    this.ended = true;
    this.socket?.close(1000);
    this.abandon(why);
    this.state.set({ state: "refused", why, code: error instanceof RefusedError ? error.refusal.code : null });
  }

  private closed(socket: Socket): void {
    if (this.socket !== socket) return;
    this.socket = null;
    // A hello that was never answered is not asked again: the next connection has its own.
    for (const [id, { name }] of this.pending) {
      if (name === "hello") this.pending.delete(id);
    }
    if (!this.ended) this.retry(this.bye ?? "The connection was lost.");
  }

  private retry(why: string): void {
    const seconds = Math.min(kMaxWaitSeconds, 2 ** this.tries++ / 2);
    this.state.set({ state: "lost", why, seconds });
    this.options.later(seconds * 1000, () => {
      if (!this.ended && this.state.value.state === "lost") this.connect();
    });
  }

  private async take(data: string | ArrayBuffer): Promise<void> {
    try {
      if (typeof data === "string") this.takeText(readText(data));
      else await this.takeFrame(data);
    } catch (error) {
      // What is held cannot be trusted now, whether the server said what cannot be understood or this page failed at it: begin anew.
      const understood = !(error instanceof TextError || error instanceof FrameError);
      if (understood) console.error(error);
      this.bye = `${understood ? "This page failed at what the server said" : "The server said something that this page does not understand"}: ${explain(error)}.`;
      this.lastComplete = null;
      this.socket?.close(kNotTaken);
    }
  }

  private takeText(text: ServerText): void {
    if (text.what === "event") {
      if (text.event === "bye") this.bye = text.body.message;
      if (text.event === "complete" && text.body.stream === kMapStream) this.completed(text.body);
      this.onEvent(text);
      return;
    }
    const pending = this.pending.get(text.id);
    if (!pending) return;
    this.pending.delete(text.id);
    if (text.what === "error") pending.reject(new RefusedError(text.refusal));
    else pending.resolve({ fields: text.fields, frame: pending.frame });
  }

  /** While a view waits for its answer this is still about the one before. */
  private completed({ epoch, revision }: Events["complete"]): void {
    if (![...this.pending.values()].some(({ looks }) => looks)) this.lastComplete = { epoch, revision };
  }

  private async takeFrame(data: ArrayBuffer): Promise<void> {
    const frame = await readFrame(new Uint8Array(data));
    if (frame.kind === "points" || frame.kind === "cells") {
      const pending = this.pending.get(frame.request);
      if (pending) pending.frame = frame;
      return;
    }
    this.onBlocks(frame);
    this.taken += data.byteLength;
    if (this.granted - this.taken < kCreditAhead / 2) this.grant();
  }

  private grant(): void {
    this.granted = this.taken + kCreditAhead;
    this.notice("credit", { bytes: this.granted });
  }

  /** Tells the time, and finds out that nobody is there where the network only went silent. */
  private check(socket: Socket | null): void {
    if (!socket || this.socket !== socket) return;
    const sent = this.options.now();
    if (sent - this.heardAt > kSilentMs) {
      socket.close();
      this.closed(socket);
      return;
    }
    this.request("clock", { t0: sent }).then(
      ({ t1, t2 }) => this.clock.hear(sent, t1, t2, this.options.now()),
      () => {}, // the next one comes anyhow, and nobody waits for this
    );
    this.options.later(kCheckMs, () => {
      // Only what has lasted a while is good again: one that lets us in and then fails at once is not tried at once.
      if (this.socket === socket) this.tries = 0;
      this.check(socket);
    });
  }
}
