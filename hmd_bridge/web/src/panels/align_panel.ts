/** Bringing maps together: by hand, refined, accepted, undone. */
import type { App } from "../app";
import type { Evidence } from "../../generated/messages";
import { button, el, field, live, none, section, select } from "../base/dom";
import type { Aligning } from "../edit/align_session";
import type { Slip } from "../link/world";

const kStep = 0.25;
const kTurn = Math.PI / 36;

export function alignPanel(app: App): HTMLElement {
  const { align, world } = app;
  const slips = live((redraw) => world.slips.watch(redraw), () => world.slips.value.map((slip) => slipCard(app, slip)));
  const body = live(
    (redraw) => {
      align.current.watch(redraw);
      world.agents.onChange(() => align.current.value || redraw());
    },
    () => (align.current.value ? session(app, align.current.value) : [chooser(app)]),
  );
  return el("div", {}, slips, section("Align a map", body));
}

function chooser(app: App): HTMLElement {
  const agents = app.world.agents.value;
  if (agents.length === 0) return none("There are no agents to align.");
  const first = [...agents].sort((a, b) => Number(a.aligned) - Number(b.aligned));
  const source = select(first.map(({ agent, aligned }) => ({ value: agent, title: aligned ? agent : `${agent} (not aligned)` })), { "aria-label": "Map to be placed" });
  const target = select([{ value: "", title: "the map" }, ...agents.map(({ agent }) => ({ value: agent, title: agent }))], { "aria-label": "Where it is placed" });
  const begin = (): void => {
    const to = target.value === "" ? undefined : target.value;
    void app.align.begin(source.value, to, to === undefined ? app.world.agent(source.value)?.T_map_agent : undefined);
  };
  return el("div", {}, field("Place", source), field("Into", target),
    el("div", { class: "row" }, button("Begin", begin, { class: "main", disabled: !app.mayEdit }), button("Undo its last move", () => void app.align.undo(source.value), { disabled: !app.mayEdit })));
}

function session(app: App, { source, target, offer, busy }: Aligning): HTMLElement[] {
  const { align } = app;
  const nudge = (title: string, words: string, x: number, y: number, z: number, yaw: number): HTMLButtonElement =>
    button(title, () => align.nudge([x * kStep, y * kStep, z * kStep], yaw * kTurn), { "aria-label": words, title: words });
  return [
    el("p", { class: "hint" }, `The light blue cubes are ${source}. Drag them onto ${target ?? "the map"} (Shift turns), or use the buttons. Then let the fit be refined.`),
    el("div", { class: "nudges" },
      nudge("↺", "Turn left", 0, 0, 0, 1), nudge("↑", "North", 0, 1, 0, 0), nudge("↻", "Turn right", 0, 0, 0, -1),
      nudge("←", "West", -1, 0, 0, 0), nudge("↓", "South", 0, -1, 0, 0), nudge("→", "East", 1, 0, 0, 0),
      nudge("⤒", "Up", 0, 0, 1, 0), nudge("⤓", "Down", 0, 0, -1, 0)),
    ...(offer ? [evidence(offer.evidence)] : []),
    el("div", { class: "row" },
      button(busy ? "Looking…" : "Refine", () => void align.refine(), { class: offer ? "" : "main", disabled: busy }),
      button("Find anywhere", () => void align.refine(true), { disabled: busy }),
      button("Accept", () => void align.accept(), { class: "main", disabled: !offer || busy })),
    el("div", { class: "row" },
      button("Leave it as I placed it", () => void align.placeAsIs(), { disabled: busy || target !== undefined }),
      button("Cancel", () => align.cancel())),
  ];
}

export function evidenceWords({ overlap, rms, free_space_violation, loose }: Evidence): string {
  const open = loose.length > 0 ? ` Not pinned down: ${loose.join(", ")}.` : "";
  return `${Math.round(overlap * 100)} % overlap, ${(rms * 100).toFixed(1)} cm apart, ${Math.round(free_space_violation * 100)} % where the other saw free space.${open}`;
}

const evidence = (found: Evidence): HTMLElement => el("p", { class: "evidence" }, evidenceWords(found));

function slipCard(app: App, { agent, align, slip, slip_angle, evidence: found }: Slip): HTMLElement {
  const words = `${agent} seems to have slipped by ${slip.toFixed(2)} m and ${Math.round((slip_angle * 180) / Math.PI)}°.`;
  return el("article", { class: "alert" }, el("p", {}, words), evidence(found),
    el("div", { class: "row" },
      button("Correct it", () => void app.news.tell(app.ask("align_accept", { align }), () => `${agent} was corrected.`), { class: "main", disabled: !app.mayEdit }),
      button("Leave it", () => void app.news.tell(app.ask("align_drop", { align }), () => "Left as it is."), { disabled: !app.mayEdit })));
}
