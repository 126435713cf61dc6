/** Puts the page together. */
import { App } from "./app";
import { el } from "./base/dom";
import { News } from "./base/news";
import { Link, type Socket } from "./link/link";
import { fetchTicket, storedToken, storeToken, ticketNeeded } from "./link/ticket";
import { World } from "./link/world";
import { budgetOf } from "./map/level_of_detail";
import { newsBox, questionBox, statusBar, tokenDialog } from "./panels/chrome";
import { Desk } from "./panels/desk";
import { Stage } from "./scene/stage";

const kWorkers = 2;

function deviceName(): string {
  const agent = navigator.userAgent;
  if (/HoloLens/i.test(agent)) return "HoloLens 2";
  if (/Quest 3/i.test(agent)) return "Quest 3";
  if (/OculusBrowser|Quest/i.test(agent)) return "Quest";
  return /Mobi/i.test(agent) ? "Phone" : "Browser";
}

function main(): void {
  const canvas = document.querySelector<HTMLCanvasElement>("#canvas")!;
  const view = document.querySelector<HTMLElement>("#view")!;
  const side = document.querySelector<HTMLElement>("#side")!;
  const bar = document.querySelector<HTMLElement>("#bar")!;

  const world = new World();
  const news = new News();
  const stage = new Stage(canvas);
  new ResizeObserver(() => stage.resize(view.clientWidth, view.clientHeight)).observe(view);

  const link = new Link({
    open: () => new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/ws`, "hmd.v1") as unknown as Socket,
    ticket: async () => ((await ticketNeeded()) ? fetchTicket(storedToken()) : undefined),
    who: () => ({ device: deviceName() }),
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
    if (state.state === "refused") dialog.showModal();
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
    const desk = new Desk(app, canvas, side);
    view.append(desk.viewButtons(), questionBox(app));
    (window as unknown as { concord: App }).concord = app;
  };
  side.append(el("p", { class: "none" }, "Connecting to the server…"));
  link.connect();
}

main();
