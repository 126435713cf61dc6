/** The menu in the scene: pages of buttons, and what they do. */
import type { App } from "../app";
import { counted } from "../base/news";
import { Signal } from "../base/signal";
import { add, distance, scale } from "../base/vec";
import { conflictWords, cornersOf } from "../edit/conflict_tour";
import { correct, pathWords, refer, send, whatIf } from "../edit/robot_acts";
import { kTools, type Tool } from "../edit/selection";
import type { Asset, ConflictRegion, Instance } from "../../generated/messages";
import { evidenceWords } from "../panels/align_panel";
import { vec } from "../scene/three_pose";
import { keyboardPage, typed } from "./keyboard";
import type { OwnFrame } from "./own_frame";
import type { PanelButton, PanelPage } from "./panel_layout";
import type { RoomView } from "./room_view";

type PageName = "main" | "edit" | "robots" | "align" | "things" | "conflicts";
const kMostRows = 5;
const kNudge = 0.25;
const kBack: PanelButton = { id: "page main", title: "‹ Menu" };

export class Menu {
  /** What is to be shown. */
  readonly page: Signal<PanelPage>;
  /** Points are taken at the hand instead of where its ray ends. */
  readonly atHand = new Signal(false);
  onLeave: () => void = () => {};
  private name: PageName = "main";
  private typing: { hint: string; text: string; done: (text: string | null) => void } | null = null;
  private assets: Asset[] = [];
  private picked: Instance | null = null;

  constructor(
    private readonly app: App,
    private readonly own: OwnFrame,
    private readonly room: RoomView,
  ) {
    this.page = new Signal(this.make());
    const renew = (): void => this.page.set(this.make());
    const { editor, align, conflicts, world, news, draft } = app;
    const shown: { onChange: (watcher: () => void) => unknown }[] = [
      editor.selection, editor.blocked, editor.question, editor.undoable, editor.redoable, align.current, align.referred, world.agents, world.detections,
      conflicts.found, world.paths, news.latest, draft.open, own.standing, room.scanning, this.atHand,
    ];
    for (const signal of shown) signal.onChange(renew);
  }

  press(id: string): void {
    const [verb, what] = [id.slice(0, id.indexOf(" ")), id.slice(id.indexOf(" ") + 1)];
    if (verb === "page") this.turnTo(what as PageName);
    else if (verb === "key") this.type(id);
    else if (verb === "text") this.endTyping(what === "done");
    else if (verb === "tool") this.app.editor.begin(what as Tool);
    else if (verb === "robot") this.robot(what);
    else if (verb === "with") void this.app.align.begin(this.own.agent, what);
    else if (verb === "yes") void this.app.confirm(what);
    else if (verb === "no") void this.app.news.tell(this.app.ask("detection_reject", { detection: what }), () => "Rejected.");
    else if (verb === "asset") void this.app.putAsset(what, what, 0);
    else this.acts[what]?.();
  }

  private readonly acts: Record<string, () => void> = {
    sendMap: () => void this.app.sendMap(),
    getScene: () => void this.app.getScene(),
    sendScene: () => void this.app.draft.send(),
    scan: () => this.room.scanning.set(!this.room.scanning.value),
    leave: () => this.onLeave(),
    done: () => this.app.editor.end(),
    back: () => this.app.editor.back(),
    cancel: () => this.app.editor.cancel(),
    add: () => void this.app.editor.apply("add"),
    delete: () => void this.app.editor.apply("delete"),
    move: () => void this.app.editor.move(),
    undo: () => void this.app.editor.undo(),
    redo: () => void this.app.editor.redo(),
    obstacle: () => void this.app.obstacles.add(),
    removeObstacle: () => void this.app.obstacles.remove(this.app.obstacles.own.value.at(-1)!),
    label: () => void this.withText("What is it?", (text) => this.app.editor.label(text)),
    touch: () => void this.app.editor.touch(() => this.text("What is it?")),
    pick: () => void this.pick(),
    dropLabel: () => void this.with((thing) => this.app.removeThing(thing, true)),
    deleteThing: () => void this.with((thing) => (thing.asset === undefined ? this.app.removeThing(thing, false) : this.app.removeAsset(thing))),
    moveThing: () => void this.with((thing) => this.app.moveAsset(thing)),
    reassign: () => void this.with((thing) => this.withText(`What is ${thing.class_name} ${thing.instance}?`, (text) => this.app.reassign(thing, text))),
    zone: () => void this.withText("Name of the keep-out zone", (text) => this.app.editor.zone(text, "no_go")),
    atHand: () => this.atHand.set(!this.atHand.value),
    refine: () => void this.app.align.refine(),
    anywhere: () => void this.app.align.refine(true),
    accept: () => void this.app.align.accept(),
    dropAlign: () => this.app.align.cancel(),
    acceptReferred: () => void this.app.align.acceptReferred(),
    dropReferred: () => this.app.align.dropReferred(),
    undoAlign: () => void this.app.align.undo(this.own.agent),
    conflictsAgain: () => void this.app.showConflicts(),
    conflictsHide: () => this.app.layers.hide("conflicts"),
    conflictBefore: () => this.app.conflicts.step(-1),
    conflictNext: () => this.app.conflicts.step(1),
    up: () => this.app.align.nudge([0, 0, kNudge], 0),
    down: () => this.app.align.nudge([0, 0, -kNudge], 0),
    left: () => this.app.align.nudge([0, 0, 0], 0.1),
    right: () => this.app.align.nudge([0, 0, 0], -0.1),
  };

  private make(): PanelPage {
    if (this.typing) return keyboardPage(this.typing.hint, this.typing.text);
    const { title, rows } = { main: this.main, edit: this.edit, robots: this.robots, align: this.aligning, things: this.things, conflicts: this.conflicts }[this.name].call(this);
    return { title, words: this.words(), rows };
  }

  private words(): string {
    const { editor, news, world } = this.app;
    const item = news.latest.value;
    if (item) return item.text;
    if (editor.question.value) return editor.question.value.hint.replace("Click", "Point at");
    if (this.name !== "align" && editor.blocked.value !== null) return editor.blocked.value;
    if (this.name === "conflicts" && this.app.conflicts.region) return conflictWords(this.app.conflicts.region);
    const path = this.name === "robots" && [...world.paths.value.values()].at(-1);
    if (path) return `${path.robot}: ${pathWords(path)}`;
    const selection = editor.selection.value;
    if (selection && !selection.closed) return kTools.find(({ tool }) => tool === selection.tool)!.hint.replace("Click", "Point at and press on");
    return "Point with your hand or controller; pinch or press the trigger.";
  }

  private main(): Omit<PanelPage, "words"> {
    const where = { aligned: "in the map", unaligned: "not aligned", lost: "tracking lost" }[this.own.standing.value.state];
    return {
      title: `Concord: ${where}`,
      rows: [
        [{ id: "page edit", title: "Edit" }, { id: "page robots", title: "Robots" }],
        [{ id: "page align", title: "Align", main: this.own.standing.value.state === "unaligned" }, { id: "page things", title: "Things" }, { id: "page conflicts", title: "Conflicts" }],
        [{ id: "do sendMap", title: "Send Map" }, { id: "do getScene", title: "Get Scene" }, { id: "do sendScene", title: "Send Scene", disabled: !this.app.draft.open.value }],
        [{ id: "do scan", title: this.room.scanning.value ? "Scanning" : "Scan the room", pressed: this.room.scanning.value }, { id: "do leave", title: "Leave" }],
      ],
    };
  }

  private edit(): Omit<PanelPage, "words"> {
    const { editor } = this.app;
    const selected = editor.selection.value?.tool;
    const off = editor.blocked.value !== null || !this.app.mayEdit;
    return {
      title: "Edit",
      rows: [
        kTools.map(({ tool, title }) => ({ id: `tool ${tool}`, title, pressed: tool === selected })),
        [{ id: "do done", title: "Done" }, { id: "do back", title: "Back" }, { id: "do cancel", title: "Cancel" }, { id: "do move", title: "Move…", disabled: off }],
        [{ id: "do add", title: "Add", main: true, disabled: off }, { id: "do delete", title: "Delete", main: true, disabled: off }, { id: "do undo", title: "Undo", disabled: !editor.canUndo }, { id: "do redo", title: "Redo", disabled: editor.redoable.value.length === 0 }],
        [{ id: "do label", title: "Label…", disabled: off }, { id: "do touch", title: "Name a thing…", share: 1.4, disabled: off }, { id: "do zone", title: "Keep out…", disabled: off }, { id: "do obstacle", title: "Obstacle", disabled: off }],
        [kBack, { id: "do atHand", title: this.atHand.value ? "Points at my hand" : "Points where I aim", share: 2 }],
      ],
    };
  }

  private robots(): Omit<PanelPage, "words"> {
    const unplaced = this.app.editor.blocked.value !== null;
    const rows = this.app.world.robots().slice(0, kMostRows).map(({ agent }) => [
      { id: `robot path/${agent}`, title: agent, share: 1.3, pressed: this.app.world.paths.value.has(agent) },
      { id: `robot what/${agent}`, title: "Way to…", disabled: unplaced || !this.app.mayEdit },
      { id: `robot send/${agent}`, title: "Send to…", disabled: unplaced || !this.app.mayDrive },
      { id: `robot here/${agent}`, title: "Is here…", disabled: unplaced || !this.app.mayDrive },
    ]);
    return { title: "Robots: press a name for its path", rows: [...rows, [kBack, { id: "do removeObstacle", title: "Remove last obstacle", share: 2, disabled: this.app.obstacles.own.value.length === 0 }]] };
  }

  private aligning(): Omit<PanelPage, "words"> {
    const referred = this.app.align.referred.value;
    if (referred) {
      return {
        title: evidenceWords(referred.offer.evidence),
        rows: [[{ id: "do acceptReferred", title: `Accept: found from ${referred.robot}`, main: true, share: 2 }, { id: "do dropReferred", title: "Cancel" }, kBack]],
      };
    }
    const now = this.app.align.current.value;
    if (!now) {
      const others = this.app.world.agents.value.filter(({ agent, occupied }) => agent !== this.own.agent && occupied > 0).slice(0, kMostRows);
      const robots = new Set(this.app.world.robots().map(({ agent }) => agent));
      const rows = others.map(({ agent }) => [{ id: `with ${agent}`, title: agent, share: 2 }, ...(robots.has(agent) ? [{ id: `robot see/${agent}`, title: "I see it…" }] : [])]);
      return { title: "Align your room with…", rows: [...rows, [kBack, { id: "do undoAlign", title: "Undo last", share: 2 }]] };
    }
    return {
      title: now.offer ? evidenceWords(now.offer.evidence) : "Take the blue map and put it onto the grey one",
      rows: [
        [{ id: "do left", title: "↺" }, { id: "do right", title: "↻" }, { id: "do up", title: "Up" }, { id: "do down", title: "Down" }],
        [{ id: "do refine", title: now.busy ? "Looking…" : "Refine", main: !now.offer, disabled: now.busy }, { id: "do anywhere", title: "Find anywhere", disabled: now.busy }],
        [{ id: "do accept", title: "Accept", main: true, disabled: !now.offer }, { id: "do dropAlign", title: "Cancel" }, kBack],
      ],
    };
  }

  private things(): Omit<PanelPage, "words"> {
    const detected = this.app.world.detections.value.slice(0, 2).map(({ detection, class_name }) => [
      { id: `yes ${detection}`, title: `${class_name} is there`, share: 2, disabled: !this.app.mayEdit },
      { id: `no ${detection}`, title: "It is not", disabled: !this.app.mayEdit },
    ]);
    const assets = this.assets.slice(0, kMostRows).map(({ asset, class_name }) => [{ id: `asset ${asset}`, title: `Put a ${class_name}: ${asset}`, disabled: this.app.editor.blocked.value !== null }]);
    const off = this.app.editor.blocked.value !== null || !this.app.mayEdit;
    const thing = this.picked;
    const act = thing?.asset === undefined ? { id: "do dropLabel", title: "Drop label", disabled: off } : { id: "do moveThing", title: "Move…", disabled: off };
    const picked = thing ? [[{ id: "do deleteThing", title: "Delete", disabled: off }, act, { id: "do reassign", title: "It is a…", disabled: off }]] : [];
    return { title: thing ? `${thing.class_name} ${thing.instance}` : "Things", rows: [...detected, ...assets, ...picked, [kBack, { id: "do pick", title: "Pick a thing…", share: 2 }]] };
  }

  private conflicts(): Omit<PanelPage, "words"> {
    const { found, region } = this.app.conflicts;
    const now = found.value;
    const off = !now || now.regions.length === 0;
    const place = now && region ? `${now.at! + 1} of ${now.regions.length}, ${this.metresTo(region)} m away` : null;
    const none = now && (off ? "All agents agree" : `${counted(now.voxels, "voxel")} in dispute`);
    return {
      title: place ?? none ?? "Where agents disagree",
      rows: [
        [{ id: "do conflictBefore", title: "‹ Before", disabled: off }, { id: "do conflictNext", title: "Next ›", main: true, disabled: off }],
        [kBack, { id: "do conflictsAgain", title: "Ask again" }, { id: "do conflictsHide", title: "Hide" }],
      ],
    };
  }

  private metresTo(region: ConflictRegion): string {
    const [low, high] = cornersOf(region, this.app.layers.resolution);
    return distance(this.app.eyes.here(), scale(add(low, high), 0.5)).toFixed(1);
  }

  private async pick(): Promise<void> {
    const p = await this.app.editor.askPoint("Click a labelled thing.");
    this.picked = p && this.app.thingAt(p);
    if (p && !this.picked) this.app.news.failed("Nothing is labelled there.");
    this.page.set(this.make());
  }

  /** Does something with the thing that was picked, which is then picked no more. */
  private async with(act: (thing: Instance) => Promise<void>): Promise<void> {
    const thing = this.picked;
    this.picked = null;
    this.page.set(this.make());
    if (thing) await act(thing);
  }

  private turnTo(name: PageName): void {
    this.name = name;
    if (name === "things") void this.loadAssets();
    if (name === "conflicts") void this.app.showConflicts();
    this.page.set(this.make());
  }

  private async loadAssets(): Promise<void> {
    const answer = await this.app.news.tell(this.app.ask("assets", {}), () => null);
    if (!answer) return;
    this.assets = answer.assets;
    this.page.set(this.make());
  }

  private robot(what: string): void {
    const [verb, robot] = [what.slice(0, what.indexOf("/")), what.slice(what.indexOf("/") + 1)];
    if (verb === "path") void this.app.followPath(robot, !this.app.world.paths.value.has(robot));
    if (verb === "what") void whatIf(this.app, robot);
    if (verb === "send") void send(this.app, robot);
    if (verb === "here") void correct(this.app, robot);
    if (verb === "see") void refer(this.app, robot, (p) => vec(this.app.stage.own.worldToLocal(this.app.stage.fromMap(p))));
  }

  /** What the person types; null if they would rather not. */
  private text(hint: string): Promise<string | null> {
    return new Promise((done) => {
      this.typing = { hint, text: "", done };
      this.page.set(this.make());
    });
  }

  private async withText(hint: string, act: (text: string) => Promise<void>): Promise<void> {
    const text = await this.text(hint);
    if (text !== null) await act(text);
  }

  private type(id: string): void {
    if (!this.typing) return;
    this.typing.text = typed(this.typing.text, id);
    this.page.set(this.make());
  }

  private endTyping(done: boolean): void {
    const typing = this.typing;
    this.typing = null;
    this.page.set(this.make());
    typing?.done(done ? typing.text.trim() : null);
  }
}
