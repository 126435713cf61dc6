/** Selecting and changing: tools, voxels, labels, zones, the scene that is sent at once. */
import type { App } from "../app";
import { button, el, field, live, none, section, select } from "../base/dom";
import { counted } from "../base/news";
import type { Zone, ZoneKind } from "../../generated/messages";
import { kTools } from "../edit/selection";

export function editPanel(app: App): HTMLElement {
  if (!app.mayEdit) return el("div", {}, none("Your role is view: you can look at everything and change nothing."));
  return el("div", {}, toolSection(app), changeSection(app), useSection(app), zonesSection(app), sceneSection(app));
}

function toolSection(app: App): HTMLElement {
  const { editor } = app;
  const tools = kTools.map(({ tool, title }, i) => {
    const choose = button(title, () => editor.begin(tool), { id: `tool-${tool}`, title: `${title} (${i + 1})` });
    editor.selection.watch((selection) => choose.setAttribute("aria-pressed", String(selection?.tool === tool)));
    return choose;
  });
  const hint = live((redraw) => editor.selection.watch(redraw), () => {
    const selection = editor.selection.value;
    if (!selection) return ["Take a tool to select a part of the map."];
    if (selection.closed) return ["Selected. Choose below what to do with it."];
    return [kTools.find(({ tool }) => tool === selection.tool)!.hint];
  }, { class: "hint", "aria-live": "polite" });
  const number = (value: number, step: number, change: (value: number) => void): HTMLInputElement => {
    const input = el("input", { type: "number", min: step, max: 20, step, value, class: "short", onchange: () => change(Number(input.value)) });
    return input;
  };
  const resolution = app.layers.resolution;
  return section("Select",
    el("div", { class: "tools", role: "group", "aria-label": "Selection tools" }, ...tools), hint,
    field("Height of boxes and prisms, m", number(editor.height.value ?? 2, 0.05, (height) => editor.setHeight(height))),
    field("Thickness of lines and areas, m", number(resolution, resolution, (thickness) => editor.setThickness(thickness))),
    el("div", { class: "row" }, button("Done", () => editor.end(), { title: "Enter" }), button("Back", () => editor.back(), { title: "Backspace" }), button("Cancel", () => editor.cancel(), { title: "Escape" })));
}

function changeSection(app: App): HTMLElement {
  const { editor } = app;
  const shift = ["x", "y", "z"].map((axis) => el("input", { type: "number", step: 0.05, value: 0, class: "short", "aria-label": `Move along ${axis}, metres` }));
  const undo = button("Undo", () => void editor.undo(), { title: "Ctrl+Z" });
  const redo = button("Redo", () => void editor.redo(), { title: "Ctrl+Y" });
  for (const each of [editor.undoable, app.draft.open]) each.onChange(() => (undo.disabled = !editor.canUndo));
  undo.disabled = !editor.canUndo;
  editor.redoable.watch((edits) => (redo.disabled = edits.length === 0));
  const blocked = live((redraw) => editor.blocked.watch(redraw), () => (editor.blocked.value === null ? [] : [editor.blocked.value]), { class: "warning" });
  return section("Change voxels", blocked,
    el("div", { class: "row" },
      button("Add", () => void editor.apply("add"), { class: "main", id: "edit-add", title: "Pin as occupied (A)" }),
      button("Delete", () => void editor.apply("delete"), { class: "main", id: "edit-delete", title: "Pin as free (Delete)" }), undo, redo),
    el("div", { class: "row" }, button("Move by", () => void editor.apply("move", shift.map((input) => Number(input.value)) as [number, number, number])), ...shift, "m"));
}

function useSection(app: App): HTMLElement {
  const { editor } = app;
  const label = el("input", { type: "text", placeholder: "what it is, such as chair", maxlength: 40, "aria-label": "Label" });
  const zone = el("input", { type: "text", placeholder: "name of the zone", maxlength: 40, "aria-label": "Name of the zone" });
  const kind = select([{ value: "no_go", title: "Keep out" }, { value: "allow_contact", title: "Contact allowed" }, { value: "costly", title: "Better not" }, { value: "corridor", title: "Corridor: ways keep to it" }], { "aria-label": "Kind of zone" });
  return section("Use the selection",
    el("div", { class: "row" }, label, button("Label", () => void editor.label(label.value.trim())),
      button("Label what I click…", () => void editor.touch(() => Promise.resolve(label.value.trim())), { title: "One touch: the whole thing that is there, without a selection" })),
    el("div", { class: "row" }, zone, kind, button("Add zone", () => void editor.zone(zone.value.trim(), kind.value as ZoneKind))),
    button("Add as virtual obstacle", () => void app.obstacles.add(), { title: "Robots take another way" }));
}

function zonesSection(app: App): HTMLElement {
  const { world } = app;
  const list = live((redraw) => world.zones.watch(redraw), () => {
    if (world.zones.value.length === 0) return [none("There are no zones.")];
    return world.zones.value.map((zone) => zoneRow(app, zone));
  });
  return section("Zones", el("p", { class: "quiet" }, "Zones tell the planner where robots should not go. They are no safety function."), list);
}

function zoneRow(app: App, { name, zone_kind, author, revision, volume, T_map_zone }: Zone): HTMLElement {
  const other: ZoneKind = zone_kind === "no_go" ? "allow_contact" : "no_go";
  const words: Record<ZoneKind, string> = { no_go: "keep out", allow_contact: "contact allowed", costly: "better not", corridor: "corridor" };
  // A zone's volume is in its own frame; only one that is not turned against the map can be said again in the map's.
  const still = T_map_zone.position.every((c) => c === 0) && T_map_zone.rotation[3] === 1;
  const change = (): Promise<unknown> =>
    app.news.tell(app.ask("zone_change", { name, zone_kind: other, frame: "map", volume, base_revision: revision }), () => `Zone ${name}: ${words[other]}.`);
  return el("div", { class: "row between" }, el("span", {}, `${name}: ${words[zone_kind]}, by ${author || "somebody"}`),
    el("span", { class: "row" },
      button("Switch", () => void change(), { title: `Make it: ${words[other]}`, disabled: !still, "aria-label": `Make zone ${name}: ${words[other]}` }),
      button("To selection", () => void app.editor.reshapeZone(name, zone_kind, revision), { title: "Give it the volume that is selected", "aria-label": `Give zone ${name} the selected volume` }),
      button("Delete", () => void app.news.tell(app.ask("zone_delete", { name, base_revision: revision }), () => `Zone ${name} deleted.`), { class: "danger", "aria-label": `Delete zone ${name}` })));
}

function sceneSection(app: App): HTMLElement {
  const { draft } = app;
  const words = live((redraw) => draft.open.watch(redraw), () => {
    const open = draft.open.value;
    if (!open) return [none("Get Scene takes what is around you; your edits then wait until Send Scene sends them all at once.")];
    return [el("p", { class: "hint" }, `Unsent: ${counted(open.edits.length, "change")}, ${counted(open.zones.length, "zone")}.`)];
  });
  return section("Scene", words, el("div", { class: "row" },
    button("Get Scene", () => void app.getScene()), button("Send Scene", () => void draft.send(), { class: "main" }), button("Discard", () => draft.discard())));
}
