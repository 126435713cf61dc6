/** What is looked at: layers, heights, agents, conflicts, saved maps. */
import type { App } from "../app";
import { counted } from "../base/news";
import { button, el, field, live, none, section, select } from "../base/dom";
import { Signal } from "../base/signal";
import { conflictWords, cornersOf } from "../edit/conflict_tour";
import type { Agent, ConflictRegion, SavedMap } from "../../generated/messages";
import { kLayers } from "../scene/map_layers";

export function mapPanel(app: App): HTMLElement {
  return el("div", {}, layersSection(app), heightsSection(app), gridSection(app), agentsSection(app), conflictsSection(app), mapsSection(app));
}

function layersSection(app: App): HTMLElement {
  const boxes = kLayers.map(({ layer, title }) => {
    const box = el("input", {
      type: "checkbox",
      id: `layer-${layer}`,
      onchange: () => (box.checked ? app.layers.show(layer) : app.layers.hide(layer)),
    });
    app.layers.changed.watch(() => (box.checked = app.layers.isShown(layer)));
    return el("label", { class: "check" }, box, title);
  });
  return section("Layers", ...boxes);
}

function heightsSection(app: App): HTMLElement {
  const slider = (title: string, value: number): HTMLInputElement =>
    el("input", { type: "range", min: -2, max: 6, step: 0.1, value, "aria-label": title, oninput: () => change() });
  const low = slider("Lowest height shown", -2);
  const high = slider("Highest height shown", 6);
  const words = el("p", { class: "quiet" });
  const change = (): void => {
    const [from, to] = [Number(low.value), Number(high.value)].sort((a, b) => a - b) as [number, number];
    const all = from <= -2 && to >= 6;
    words.textContent = all ? "All heights are shown." : `Shown: ${from.toFixed(1)} m to ${to.toFixed(1)} m.`;
    app.layers.clip.set(all ? null : [from, to]);
  };
  change();
  return section("Heights", field("From", low), field("To", high), words);
}

function gridSection(app: App): HTMLElement {
  const height = (value: number, title: string): HTMLInputElement => el("input", { type: "number", step: 0.1, value, class: "short", "aria-label": title });
  const low = height(0.2, "Grid from, metres");
  const high = height(1.5, "Grid to, metres");
  const show = async (): Promise<void> => {
    const asked = app.link.requestFrame("grid", { z: [Number(low.value), Number(high.value)] }, "cells");
    const answer = await app.news.tell(asked, ({ answer: { occupied, free } }) => `${counted(occupied, "cell")} occupied, ${counted(free, "cell")} free.`);
    const refused = answer && app.grid.show(answer.frame, Number(low.value));
    if (refused) app.news.failed(refused);
  };
  return section("2D grid", el("div", { class: "row" }, "from", low, "to", high, "m", button("Show", () => void show()), button("Hide", () => app.grid.hide())));
}

function agentsSection(app: App): HTMLElement {
  const list = live(
    (redraw) => {
      app.world.agents.watch(redraw);
      app.layers.changed.onChange(redraw);
    },
    () => (app.world.agents.value.length === 0 ? [none("Nobody maps here yet.")] : app.world.agents.value.map((agent) => agentCard(app, agent))),
  );
  return section("Agents", list);
}

function agentCard(app: App, agent: Agent): HTMLElement {
  const shown = app.layers.isShown("agent", agent.agent);
  const weight = el("input", {
    type: "number", min: 1, max: 1000, value: agent.weight, class: "short", "aria-label": `Weight of ${agent.agent}`, disabled: !app.mayEdit,
    onchange: () => void app.news.tell(app.ask("weight", { agent: agent.agent, weight: Number(weight.value) }), () => `${agent.agent} now weighs ${weight.value}.`),
  });
  return el("article", {},
    el("header", {}, el("strong", {}, agent.agent), el("span", { class: agent.aligned ? "badge good" : "badge bad" }, agent.aligned ? "in the map" : "not aligned")),
    el("p", { class: "quiet" }, `${agent.type}, ${counted(agent.occupied, "occupied voxel")}`),
    field("Weight", weight),
    el("div", { class: "row" },
      button(shown ? "Hide its own map" : "Show its own map", () => (shown ? app.layers.hide("agent", agent.agent) : app.layers.show("agent", agent.agent))),
      confirmed("Reset", `Drop all that ${agent.agent} has mapped?`, () => app.news.tell(app.ask("reset", { agent: agent.agent }), () => `${agent.agent} begins anew.`), app),
      confirmed("Remove", `Forget ${agent.agent} and its map?`, () => app.news.tell(app.ask("remove", { agent: agent.agent }), () => `${agent.agent} was removed.`), app)));
}

/** A button for what cannot be undone. */
export function confirmed(title: string, question: string, act: () => Promise<unknown>, app: App): HTMLButtonElement {
  return button(title, () => void (confirm(question) && act()), { class: "danger", disabled: !app.mayEdit });
}

function conflictsSection(app: App): HTMLElement {
  const { found } = app.conflicts;
  const list = live((redraw) => found.watch(redraw), () => {
    if (!found.value) return [];
    if (found.value.regions.length === 0) return [none("All agents agree.")];
    return [el("p", { class: "quiet" }, `${counted(found.value.voxels, "voxel")} in dispute; the largest places first:`), ...found.value.regions.map((region, i) => conflictRow(app, region, i))];
  });
  return section("Conflicts", button("Show where agents disagree", () => void app.showConflicts()), list);
}

function conflictRow(app: App, region: ConflictRegion, i: number): HTMLElement {
  const look = (): void => {
    app.conflicts.look(i);
    app.eyes.lookAt(...cornersOf(region, app.layers.resolution));
  };
  return button(conflictWords(region), look, { class: "line" });
}

function mapsSection(app: App): HTMLElement {
  const maps = new Signal<SavedMap[] | null>(null);
  const refresh = async (): Promise<void> => {
    const answer = await app.news.tell(app.ask("maps", {}), () => null);
    if (answer) maps.set(answer.maps);
  };
  const name = el("input", { type: "text", placeholder: "name, such as ground-floor", maxlength: 40, "aria-label": "Name of the saved map" });
  const format = select([{ value: "concord", title: "Concord: everything" }, { value: "bt", title: "OctoMap .bt" }, { value: "ot", title: "OctoMap .ot" }], { "aria-label": "Format" });
  const over = el("input", { type: "checkbox" });
  const save = async (): Promise<void> => {
    const formats = [format.value as "concord" | "bt" | "ot"];
    await app.news.tell(app.ask("save", { map: name.value.trim(), formats, overwrite: over.checked }), ({ files }) => `Saved: ${files.map(({ file }) => file).join(", ")}.`);
    await refresh();
  };
  const load = async (file: string): Promise<void> => {
    const dot = file.lastIndexOf(".");
    const asked = app.ask("load", { map: file.slice(0, dot), format: file.slice(dot + 1) as "concord" | "bt" | "ot" });
    await app.news.tell(asked, ({ agent, voxels }) => `${agent} loaded, ${counted(voxels, "voxel")}. Align it to see it in the map.`);
  };
  const list = live((redraw) => maps.watch(redraw), () => {
    if (!maps.value) return [];
    if (maps.value.length === 0) return [none("Nothing is saved yet.")];
    return maps.value.map(({ file, bytes }) => el("div", { class: "row between" }, el("span", {}, `${file}, ${(bytes / 1e6).toFixed(2)} MB`), button("Load", () => void load(file), { disabled: !app.mayEdit, "aria-label": `Load ${file}` })));
  });
  return section("Saved maps", field("Name", name), field("Format", format), el("label", { class: "check" }, over, "Replace one of this name"),
    el("div", { class: "row" }, button("Save the map", () => void save(), { class: "main", disabled: !app.mayEdit }), button("List saved maps", () => void refresh())), list);
}
