/** Labelled things, assets that can be put into the map, and what detectors propose. */
import type { App } from "../app";
import type { Answers, Asset, Instance, Label } from "../../generated/messages";
import { button, el, live, none, section } from "../base/dom";
import { counted } from "../base/news";
import { Signal } from "../base/signal";

export function thingsPanel(app: App): HTMLElement {
  return el("div", {}, detectionsSection(app), instancesSection(app), classesSection(app), assetsSection(app));
}

function detectionsSection(app: App): HTMLElement {
  const { detections } = app.world;
  const list = live((redraw) => detections.watch(redraw), () => {
    if (detections.value.length === 0) return [none("Nothing waits for your decision.")];
    return detections.value.map(({ detection, class_name, score, by }) =>
      el("article", {}, el("p", {}, `${class_name}, seen by ${by}, ${Math.round(score * 100)} % sure`),
        el("div", { class: "row" },
          button("It is there", () => void app.confirm(detection), { class: "main", disabled: !app.mayEdit }),
          button("It is not", () => void app.news.tell(app.ask("detection_reject", { detection }), () => "Rejected."), { disabled: !app.mayEdit }))));
  });
  return section("Detected", list);
}

function instancesSection(app: App): HTMLElement {
  const list = live((redraw) => app.things.watch(redraw), () => {
    if (app.things.value.length === 0) return [none("Nothing is labelled yet.")];
    return app.things.value.map((thing) => thingCard(app, thing));
  });
  return section("Labelled things", button("Refresh", () => void app.loadThings()), list);
}

function thingCard(app: App, thing: Instance): HTMLElement {
  const { instance, class_name, voxels, min, max, asset } = thing;
  const remove = (keep: boolean): void => {
    void (asset === undefined ? app.removeThing(thing, keep) : app.removeAsset(thing));
  };
  const other = el("input", { type: "text", maxlength: 40, class: "short", placeholder: "another class", "aria-label": `Class of ${class_name} ${instance}` });
  const reassign = button("Change", () => void app.reassign(thing, other.value.trim()), { disabled: !app.mayEdit, "aria-label": `Change the class of ${class_name} ${instance}` });
  const acts = asset === undefined
    ? [button("Drop label", () => remove(true), { disabled: !app.mayEdit }), button("Delete", () => remove(false), { class: "danger", disabled: !app.mayEdit })]
    : [button("Move…", () => void app.moveAsset(thing), { disabled: !app.mayEdit }), button("Delete", () => remove(false), { class: "danger", disabled: !app.mayEdit })];
  return el("article", {},
    el("header", {}, el("strong", {}, `${class_name} ${instance}`), el("span", { class: asset === undefined ? "badge label" : "badge asset" }, asset === undefined ? "label" : "asset")),
    el("p", { class: "quiet" }, counted(voxels, "voxel")),
    el("div", { class: "row" }, button("Look", () => app.eyes.lookAt(min, max)), ...acts),
    el("div", { class: "row" }, other, reassign));
}

/** Classes of things, each of which can be taken away as a whole. */
function classesSection(app: App): HTMLElement {
  const labels = new Signal<Answers["labels"] | null>(null);
  const refresh = async (): Promise<void> => {
    const answer = await app.news.tell(app.ask("labels", {}), () => null);
    if (answer) labels.set(answer);
  };
  const remove = async ({ label, name }: Label): Promise<void> => {
    const asked = app.ask("label_delete", { label, keep_voxels: true });
    const answer = await app.news.tell(asked, ({ voxels }) => `${name} is no label any more; ${counted(voxels, "voxel")} stay as they are.`);
    if (!answer) return;
    app.editor.did(answer.undo);
    await refresh();
  };
  const rename = async (label: Label, name: string): Promise<void> => {
    const answer = await app.news.tell(app.ask("label_rename", { label: label.label, name }), () => `${label.name} is called ${name} now.`);
    if (!answer) return;
    app.editor.did(answer.undo);
    await Promise.all([refresh(), app.loadThings()]);
  };
  const list = live((redraw) => labels.watch(redraw), () => {
    if (!labels.value) return [];
    const { labels: first, in_all: inAll } = labels.value;
    if (inAll === 0) return [none("There are no labels.")];
    const rows = first.map((label) => {
      const name = el("input", { type: "text", maxlength: 40, placeholder: "another name", "aria-label": `New name of ${label.name}` });
      return el("div", { class: "row" }, el("span", { class: "line" }, `${label.name}: ${counted(label.instances, "thing")}`), name,
        button("Rename", () => void rename(label, name.value.trim()), { disabled: !app.mayEdit, "aria-label": `Rename the label ${label.name}` }),
        button("Drop", () => void remove(label), { class: "danger", disabled: !app.mayEdit, "aria-label": `Drop the label ${label.name}` }));
    });
    return inAll > first.length ? [...rows, none(`The first ${first.length} of ${counted(inAll, "label")}.`)] : rows;
  });
  return section("Labels", button("List labels", () => void refresh()), list);
}

function assetsSection(app: App): HTMLElement {
  const assets = new Signal<Asset[] | null>(null);
  const refresh = async (): Promise<void> => {
    const answer = await app.news.tell(app.ask("assets", {}), () => null);
    if (answer) assets.set(answer.assets);
  };
  const list = live((redraw) => assets.watch(redraw), () => {
    if (!assets.value) return [];
    if (assets.value.length === 0) return [none("The server has no assets.")];
    return assets.value.map((asset) => assetCard(app, asset));
  });
  return section("Assets", button("List assets", () => void refresh()), list);
}

function assetCard(app: App, { asset, class_name, size }: Asset): HTMLElement {
  const turn = el("input", { type: "number", value: 0, step: 15, class: "short", "aria-label": `Heading of ${asset}, degrees` });
  const put = async (): Promise<void> => {
    await app.putAsset(asset, class_name, (Number(turn.value) * Math.PI) / 180);
  };
  return el("article", {}, el("header", {}, el("strong", {}, asset), el("span", { class: "quiet" }, `${size.map((edge) => edge.toFixed(2)).join(" × ")} m`)),
    el("div", { class: "row" }, turn, "degrees", button("Put into the map…", () => void put(), { class: "main", disabled: !app.mayEdit })));
}
