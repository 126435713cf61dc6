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
    const edits = new Map(found.value.filter(isEdit).map((operation) => [operation.operation, operation]));
    return found.value.map((operation) => operationRow(app, operation, edits, refresh));
  });
  return el("div", {}, section("History", field("By", author), button("Refresh", () => void refresh(), { class: "main" }), list));
}

const isEdit = ({ what }: Operation): boolean => what === "add" || what === "delete" || what === "move";

/** What was done, in words. @param edits by their ids: an undo names the edit that it takes back */
export function operationWords(operation: Operation, edits: ReadonlyMap<string, Operation>): string {
  const { author, what, subject, count } = operation;
  const who = `${author || "somebody"} ${kWords[what]}`;
  if (what !== "undo" && what !== "redo") return [who, subject, count > 0 ? counted(count, "voxel") : ""].filter(Boolean).join(" ");
  const edit = edits.get(subject);
  return edit ? `${who}: ${operationWords(edit, edits)}` : `${who} ${subject || "an edit"}`;
}

function operationRow(app: App, operation: Operation, edits: ReadonlyMap<string, Operation>, refresh: () => Promise<void>): HTMLElement {
  const { utime, active, operation: edit } = operation;
  const words = operationWords(operation, edits);
  const time = new Date(utime / 1000).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
  const turn = (): Promise<unknown> => (active ? app.news.tell(app.ask("undo", { edit }), () => "Undone.") : app.news.tell(app.ask("redo", { edit }), () => "Done again."));
  return el("div", { class: active || !isEdit(operation) ? "row between" : "row between undone" }, el("span", {}, el("time", {}, time), ` ${words}`),
    ...(isEdit(operation) && app.mayEdit ? [button(active ? "Undo" : "Redo", () => void turn().then(refresh), { "aria-label": `${active ? "Undo" : "Redo"}: ${words}` })] : []));
}
