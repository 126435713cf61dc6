/** Robots: their paths, where they shall go, where they really are, and what stands in their way. */
import type { App } from "../app";
import type { RobotPose } from "../../generated/messages";
import { button, el, live, none, section } from "../base/dom";
import { correct, pathWords, send, whatIf } from "../edit/robot_acts";
import { clearanceColour } from "../scene/ribbon";

export function robotsPanel(app: App): HTMLElement {
  const { world } = app;
  const list = live(
    (redraw) => {
      world.agents.watch(redraw);
      world.paths.onChange(redraw);
    },
    () => (world.robots().length === 0 ? [none("There are no robots.")] : world.robots().map(({ agent, aligned }) => robotCard(app, agent, aligned))),
  );
  const obstacles = live((redraw) => app.obstacles.own.watch(redraw), () => {
    if (app.obstacles.own.value.length === 0) return [none("Select a box under Edit, then Add as virtual obstacle.")];
    return app.obstacles.own.value.map((obstacle, i) =>
      el("div", { class: "row between" }, `Obstacle ${i + 1}`, button("Remove", () => void app.obstacles.remove(obstacle), { "aria-label": `Remove obstacle ${i + 1}` })));
  });
  return el("div", {}, section("Robots", list), section("Colours of a path", legend()), section("Virtual obstacles", obstacles));
}

function legend(): HTMLElement {
  const rows: [number, string][] = [[0.1, "tight"], [0.45, "fair"], [1, "wide"]];
  return el("p", { class: "legend" }, ...rows.flatMap(([clearance, words]) => {
    const [r, g, b] = clearanceColour(clearance).map((c) => Math.round(c * 255));
    return [el("i", { style: `background: rgb(${r} ${g} ${b})` }), words];
  }));
}

function robotCard(app: App, robot: string, aligned: boolean): HTMLElement {
  const path = app.world.paths.value.get(robot);
  const follow = el("input", { type: "checkbox", checked: path !== undefined, onchange: () => void app.followPath(robot, follow.checked) });
  return el("article", {},
    el("header", {}, el("strong", {}, robot), whereabouts(app, robot, aligned)),
    el("label", { class: "check" }, follow, "Show its path"),
    ...(path ? [el("p", { class: path.status === "OK" ? "quiet" : "warning" }, pathWords(path))] : []),
    el("div", { class: "row" },
      button("What way to…", () => void whatIf(app, robot), { disabled: !app.mayEdit, title: "Plans without moving the robot" }),
      button("Send to…", () => void send(app, robot), { class: "main", disabled: !app.mayDrive, title: app.mayDrive ? "" : "Needs the role robot" }),
      button("It is really at…", () => void correct(app, robot), { disabled: !app.mayDrive, title: app.mayDrive ? "Corrects its pose" : "Needs the role robot" })));
}

function whereabouts(app: App, robot: string, aligned: boolean): HTMLElement {
  return live((redraw) => app.world.poses.watch(redraw), () => {
    if (!aligned) return ["not aligned"];
    const pose = app.world.poses.value.find((each: RobotPose) => each.agent === robot);
    if (!pose) return ["place unknown"];
    const [x, y] = pose.T_map_base.position;
    return [`${x.toFixed(1)}, ${y.toFixed(1)} m${pose.stale ? ", silent" : ""}`];
  }, { class: "quiet" });
}
