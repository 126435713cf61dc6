/** Tabs by the pattern of WAI-ARIA: arrow keys change them. A panel is made when it is first opened. */
import { button, el } from "../base/dom";

export interface Tab {
  title: string;
  make: () => HTMLElement;
}

export function tabs(all: readonly Tab[]): HTMLElement {
  const strip = el("div", { role: "tablist", class: "tabs", "aria-label": "Panels" });
  const body = el("div", { class: "panels" });
  const made = new Map<number, HTMLElement>();
  const open = (chosen: number): void => {
    let panel = made.get(chosen);
    if (!panel) {
      panel = el("div", { role: "tabpanel", id: `panel-${chosen}`, "aria-labelledby": `tab-${chosen}` }, all[chosen]!.make());
      made.set(chosen, panel);
      body.append(panel);
    }
    made.forEach((each, i) => (each.hidden = i !== chosen));
    [...strip.children].forEach((each, i) => {
      each.setAttribute("aria-selected", String(i === chosen));
      each.setAttribute("tabindex", i === chosen ? "0" : "-1");
    });
  };
  all.forEach(({ title }, i) => strip.append(button(title, () => open(i), { role: "tab", id: `tab-${i}`, "aria-controls": `panel-${i}` })));
  strip.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (step === undefined) return;
    const now = [...strip.children].findIndex((each) => each.getAttribute("aria-selected") === "true");
    const next = (now + step + all.length) % all.length;
    open(next);
    (strip.children[next] as HTMLElement).focus();
  });
  open(0);
  return el("div", { class: "tabbed" }, strip, body);
}
