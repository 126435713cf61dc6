/** Puts the page together. */
import { App } from "./app";
import { button, el } from "./base/dom";
import { News } from "./base/news";
import { explain } from "./link/failures";
import { Link, type Socket } from "./link/link";
import { fetchTicket, storedToken, storeToken, ticketNeeded } from "./link/ticket";
import { World } from "./link/world";
import { budgetOf } from "./map/level_of_detail";
import { newsBox, questionBox, statusBar, tokenDialog } from "./panels/chrome";
import { Desk } from "./panels/desk";
import { Stage } from "./scene/stage";
import { Immersive, immersiveSupported } from "./xr/immersive";
import { OwnFrame } from "./xr/own_frame";
import { canListen, listen } from "./xr/voice";

const kWorkers = 2;
const kAgentKey = "concord-agent";

function deviceName(): string {
  const agent = navigator.userAgent;
  if (/HoloLens/i.test(agent)) return "HoloLens 2";
  if (/Quest 3/i.test(agent)) return "Quest 3";
  if (/OculusBrowser|Quest/i.test(agent)) return "Quest";
  return /Mobi/i.test(agent) ? "Phone" : "Browser";
}

/** The same agent for the same device, from visit to visit. */
function agentName(): string {
  const name = localStorage.getItem(kAgentKey) ?? `headset-${freshId()}`;
  localStorage.setItem(kAgentKey, name);
  return name;
}

const freshId = (): string => Array.from(crypto.getRandomValues(new Uint8Array(4)), (byte) => byte.toString(16).padStart(2, "0")).join("");

const kCommands = (app: App): Record<string, () => void> => ({
  "send map": () => void app.sendMap(),
  "get scene": () => void app.getScene(),
  "send scene": () => void app.draft.send(),
  undo: () => void app.editor.undo(),
  redo: () => void app.editor.redo(),
});

function voiceButton(app: App): HTMLElement {
  let stop: (() => void) | null = null;
  const toggle = button("Voice", () => {
    if (stop) stop();
    stop = stop ? null : listen(kCommands(app));
    toggle.setAttribute("aria-pressed", String(stop !== null));
  }, { "aria-pressed": "false", title: "Say: send map, get scene, send scene, undo, redo" });
  return toggle;
}

function enterButton(app: App, immersive: Immersive): HTMLElement {
  return button("Enter the room", () => void immersive.enter().catch((error: unknown) => app.news.failed(`The headset did not let us in. ${explain(error)}`)), { class: "main", id: "enter" });
}

async function main(): Promise<void> {
  const immersiveHere = await immersiveSupported();
  let own = immersiveHere ? new OwnFrame(agentName(), freshId) : null;

  const canvas = document.querySelector<HTMLCanvasElement>("#canvas")!;
  const view = document.querySelector<HTMLElement>("#view")!;
  const side = document.querySelector<HTMLElement>("#side")!;
  const bar = document.querySelector<HTMLElement>("#bar")!;

  const world = new World();
  world.own = own?.agent ?? null;
  const news = new News();
  const stage = new Stage(canvas);
  new ResizeObserver(() => stage.resize(view.clientWidth, view.clientHeight)).observe(view);

  const link = new Link({
    open: () => new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`, "hmd.v1") as unknown as Socket,
    ticket: async () => ((await ticketNeeded()) ? fetchTicket(storedToken()) : undefined),
    who: () => ({ device: deviceName(), ...(own ? { agent: own.agent, frame_id: own.frameId.value } : {}) }),
    now: () => Date.now(),
    later: (milliseconds, what) => void setTimeout(what, milliseconds),
  });
  link.onEvent = (message) => world.hear(message);
  bar.append(statusBar(link, world));
  view.append(newsBox(news));

  const dialog = tokenDialog((token) => {
    storeToken(token);
    link.connect();
  });
  document.body.append(dialog);
  link.state.watch((state) => {
    if (state.state !== "refused") return;
    if (state.code === "DENIED" && own) {
      // Who may only look cannot be an agent, but can look.
      own = world.own = null;
      link.connect();
    } else if (state.code === "BAD_TOKEN") {
      dialog.showModal();
    }
  });

  let app: App | null = null;
  link.onReady = (hello, keep) => {
    world.role.set(hello.role);
    if (app) {
      app.renew(hello, keep);
      return;
    }
    const workers = Array.from({ length: kWorkers }, () => new Worker("mesh_worker.js", { type: "module" }));
    app = new App(link, world, stage, news, hello, budgetOf(navigator.userAgent), workers);
    const desk = new Desk(app, canvas, side, own !== null);
    const buttons = desk.viewButtons();
    view.append(buttons, questionBox(app));
    if (canListen()) buttons.append(voiceButton(app));
    const immersive = own && new Immersive(app, own);
    if (immersive) {
      immersive.onLeft = () => desk.takeOver();
      buttons.append(enterButton(app, immersive));
    }
    Object.assign(window, { concord: app, concordImmersive: immersive }); // for a console, and for tests
  };
  side.append(el("p", { class: "none" }, "Connecting to the server…"));
  link.connect();
}

void main();
