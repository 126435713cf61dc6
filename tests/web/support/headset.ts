/** An emulated headset and its hands: aims its right controller and presses its buttons. */
import { readFileSync } from "node:fs";
import type { Page } from "playwright-core";
import type { XRDevice } from "iwer";
import type { App } from "../../../hmd_bridge/web/src/app";
import type { Immersive } from "../../../hmd_bridge/web/src/xr/immersive";
import { emulatorFile, nextFrames } from "./page";
import { captureFile } from "./room";

export interface HeadsetPage {
  concord: App;
  concordImmersive: Immersive;
  xrDevice: XRDevice;
  said: string[];
}

/** Makes a fresh page one of a Quest 3 in a captured room. */
export async function enterRoom(page: Page, room: string): Promise<void> {
  await page.addInitScript(`window.concordRoom = ${readFileSync(captureFile(room), "utf8")};`);
  await page.addInitScript({ path: emulatorFile });
}

/** Keeps all that the page tells the person: it is shown for some seconds only, which may be one frame here. */
export async function hearNews(page: Page): Promise<void> {
  await page.evaluate(() => {
    const heard = window as unknown as HeadsetPage;
    heard.said = [];
    heard.concord.news.latest.onChange((item) => item && heard.said.push(item.text));
  });
}

/** Until the person has been told so, since the last time. */
export async function words(page: Page, text: string): Promise<void> {
  try {
    await page.waitForFunction((wanted) => (window as unknown as HeadsetPage).said.some((said) => said.includes(wanted)), text, { polling: 100 });
  } catch (error) {
    const said = await page.evaluate(() => (window as unknown as HeadsetPage).said);
    throw new Error(`nobody was told "${text}", but: ${JSON.stringify(said)}`, { cause: error });
  }
  await page.evaluate(() => ((window as unknown as HeadsetPage).said = []));
}

/** Turns the head towards a place of the room (y up), does something, and turns it back. */
export async function looking(page: Page, at: [number, number, number], act: () => Promise<void>): Promise<void> {
  const turn = async (yaw: number, pitch: number): Promise<void> => {
    await page.evaluate(([y, p]) => {
      const [sy, cy, sp, cp] = [Math.sin(y / 2), Math.cos(y / 2), Math.sin(p / 2), Math.cos(p / 2)];
      (window as unknown as HeadsetPage).xrDevice.quaternion.set(cy * sp, sy * cp, -sy * sp, cy * cp);
    }, [yaw, pitch] as const);
    await nextFrames(page);
    await nextFrames(page);
  };
  const { x, y, z } = await page.evaluate(() => {
    const { position } = (window as unknown as HeadsetPage).xrDevice;
    return { x: position.x, y: position.y, z: position.z };
  });
  const d = [at[0] - x, at[1] - y, at[2] - z] as const;
  await turn(Math.atan2(-d[0], -d[2]), Math.atan2(d[1], Math.hypot(d[0], d[2])));
  await act();
  await turn(0, 0);
}

/** Moves the right hand, metres in the room (y up). */
export async function drag(page: Page, by: [number, number, number]): Promise<void> {
  await page.evaluate(([x, y, z]) => {
    const { position } = (window as unknown as HeadsetPage).xrDevice.controllers.right!;
    position.set(position.x + x, position.y + y, position.z + z);
  }, by);
  await nextFrames(page);
  await nextFrames(page);
}

export const standing = (page: Page): Promise<string> => page.evaluate(() => (window as unknown as HeadsetPage).concordImmersive.own.standing.value.state);

/** Points the right controller at a place of the room (y up), at a button of the panel, or at the small maps. */
export async function aimAt(page: Page, target: [number, number, number] | "table" | { button: string }): Promise<void> {
  await page.evaluate((to) => {
    const { concordImmersive, xrDevice } = window as unknown as HeadsetPage;
    const point = concordImmersive.panel.mesh.position.clone();
    if (to === "table") {
      point.copy(concordImmersive.table.group.position);
    } else if ("button" in to) {
      const centre = concordImmersive.panel.centreOf(to.button);
      if (!centre) throw new Error(`no button ${to.button} among ${JSON.stringify(concordImmersive.panel.pageShown)}`);
      const { mesh } = concordImmersive.panel;
      point.set(centre[0] / mesh.scale.x, centre[1] / mesh.scale.y, 0).applyMatrix4(mesh.matrixWorld);
    } else {
      point.set(...to);
    }
    const hand = xrDevice.controllers.right!;
    hand.position.set(0.2, 1.35, -0.15);
    const from = point.clone().set(0.2, 1.35, -0.15);
    const object = concordImmersive.table.group.clone(false);
    object.scale.setScalar(1);
    object.position.copy(from);
    object.rotation.set(0, 0, 0);
    object.lookAt(point); // an object's +z; a controller's ray is -z
    object.rotateY(Math.PI);
    hand.quaternion.set(object.quaternion.x, object.quaternion.y, object.quaternion.z, object.quaternion.w);
  }, target);
  await nextFrames(page);
}

export async function press(page: Page, act: "select" | "squeeze", down: boolean): Promise<void> {
  await page.evaluate(([button, value]) => (window as unknown as HeadsetPage).xrDevice.controllers.right!.updateButtonValue(button, value), [act === "select" ? "trigger" : "squeeze", down ? 1 : 0] as const);
  await nextFrames(page);
}

/** Aims at a button of the panel and presses the trigger. */
export async function pressButton(page: Page, id: string): Promise<void> {
  await page.waitForFunction((button) => (window as unknown as HeadsetPage).concordImmersive.panel.centreOf(button) !== null, id);
  await aimAt(page, { button: id });
  await press(page, "select", true);
  await press(page, "select", false);
}
