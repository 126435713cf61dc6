/** Who changed what, and taking it back. */
import type { App } from "../app";
import type { Operation, OperationKind } from "../../generated/messages";
import { button, el, field, live, none, section } from "../base/dom";
import { counted } from "../base/news";
import { Signal } from "../base/signal";

const kMost = 1000;

const kWords: Record<OperationKind, string> = {
  add: "added", delete: "deleted", move: "moved", undo: "undid", redo: "redid", zone_add: "added zone", zone_change: "changed zone",
  zone_delete: "deleted zone", transform: "placed", weight: "weighed",
};

export function historyPanel(app: App): HTMLElement {
  const found = new Signal<Operation[] | null>(null);
  const author = el("input", { type: "text", placeholder: "anybody", maxlength: 40, "aria-label": "Author" });
  const refresh = async (): Promise<void> => {
    const who = author.value.trim();
    const answer = await app.news.tell(app.ask("history", { most: kMost, ...(who ? { author: who } : {}) }), () => null);
    if (answer) found.set([...answer.operations].reverse());
  };
  const list = live((redraw) => found.watch(redraw), () => {
    if (!found.value) return [none("Press Refresh to see what people changed.")];
    if (found.value.length === 0) return [none("Nobody has changed anything.")];
    return found.value.map((operation) => operationRow(app, operation, refresh));
  });
  return el("div", {}, section("History", field("By", author), button("Refresh", () => void refresh(), { class: "main" }), list));
}

function operationRow(app: App, operation: Operation, refresh: () => Promise<void>): HTMLElement {
  const { author, what, subject, count, utime, active, operation: edit } = operation;
  const words = `${author || "somebody"} ${kWords[what]} ${subject || (what === "undo" || what === "redo" ? "an edit" : "")} ${count > 0 ? counted(count, "voxel") : ""}`.trim();
  const time = new Date(utime / 1000).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
  const isEdit = what === "add" || what === "delete" || what === "move";
  const turn = (): Promise<unknown> => (active ? app.news.tell(app.ask("undo", { edit }), () => "Undone.") : app.news.tell(app.ask("redo", { edit }), () => "Done again."));
  return el("div", { class: active || !isEdit ? "row between" : "row between undone" }, el("span", {}, el("time", {}, time), ` ${words}`),
    ...(isEdit && app.mayEdit ? [button(active ? "Undo" : "Redo", () => void turn().then(refresh), { "aria-label": `${active ? "Undo" : "Redo"}: ${words}` })] : []));
}
