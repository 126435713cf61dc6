/** What frames the page: who and how connected, what was just done, and the dialog that lets people in. */
import { button, el, field, live } from "../base/dom";
import type { News } from "../base/news";
import type { App } from "../app";
import type { Link, LinkState } from "../link/link";
import type { World } from "../link/world";

const kNewsMs = 8000;

function connectionWords(state: LinkState, silent: string[]): { text: string; kind: string } {
  switch (state.state) {
    case "connecting":
      return { text: "Connecting…", kind: "wait" };
    case "ready":
      return silent.length > 0 ? { text: `Connected; silent: ${silent.join(", ")}`, kind: "wait" } : { text: "Connected", kind: "good" };
    case "lost":
      return { text: `${state.why} Trying again in ${state.seconds} s.`, kind: "bad" };
    case "refused":
      return { text: state.why, kind: "bad" };
  }
}

export function statusBar(link: Link, world: World): HTMLElement {
  const connection = el("span", { id: "connection", role: "status" });
  const say = (): void => {
    const state = link.state.value;
    const { text, kind } = connectionWords(state, world.silent.value);
    connection.textContent = text;
    connection.className = `badge ${kind}`;
    document.body.dataset["connection"] = state.state;
  };
  link.state.watch(say);
  world.silent.onChange(say);
  const who = live(
    (redraw) => {
      link.state.watch(redraw);
      world.people.onChange(redraw);
    },
    () => {
      const state = link.state.value;
      if (state.state !== "ready") return [];
      const others = world.people.value.map(({ name, device }) => name || device);
      return [`${state.hello.name || "You"}, role ${state.hello.role}`, ...(others.length > 0 ? [`; also here: ${others.join(", ")}`] : [])];
    },
    { class: "quiet" },
  );
  const slow = live((redraw) => world.lacking.watch(redraw), () => (world.lacking.value > 0 ? [`Slow connection: ${world.lacking.value} parts of the map are on their way.`] : []), { class: "quiet" });
  return el("div", { class: "status" }, who, slow, connection);
}

/** What was just done or refused; stays long enough to be read, and is spoken by screen readers. */
export function newsBox(news: News): HTMLElement {
  const box = el("div", { class: "news", role: "status", "aria-live": "polite" });
  let timer = 0;
  news.latest.watch((item) => {
    clearTimeout(timer);
    box.replaceChildren();
    if (!item) return;
    box.append(el("p", { class: item.kind }, item.text, button("×", () => news.latest.set(null), { "aria-label": "Close" })));
    timer = window.setTimeout(() => news.latest.set(null), kNewsMs);
  });
  return box;
}

/** Says what is awaited from the person: a point of the map, or the next point of their selection. */
export function questionBox(app: App): HTMLElement {
  return live((redraw) => app.editor.question.watch(redraw), () => {
    const question = app.editor.question.value;
    return question ? [el("p", {}, question.hint, button("Cancel", () => app.editor.cancel()))] : [];
  }, { class: "question", "aria-live": "polite" });
}

/** Asks for the token that `concord token` printed. */
export function tokenDialog(enter: (token: string) => void): HTMLDialogElement {
  const token = el("input", { type: "password", autocomplete: "current-password", required: true, "aria-label": "Token" });
  const form = el("form", { method: "dialog", onsubmit: () => enter(token.value.trim()) },
    el("h2", {}, "Welcome to Concord"),
    el("p", {}, "Beyond the server's own machine a token is needed. Whoever runs the server makes one:"),
    el("p", {}, el("code", {}, "concord token add YOUR-NAME --role edit")),
    field("Token", token), el("button", { class: "main" }, "Enter"));
  return el("dialog", { class: "gate" }, form);
}
