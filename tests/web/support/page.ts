/** Chromium with the page, pictures of it, and waiting for states. */
import { mkdirSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { chromium, type Browser, type Page } from "playwright-core";

const build = process.env["CONCORD_BUILD"];
if (!build) throw new Error("CONCORD_BUILD must name the build folder");
export const webFolder = join(build, "web");
export const emulatorFile = join(build, "web-tests/emulator.js");
const shots = join(build, "web-shots");

const kFlags = [
  "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-quic",
  "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
];

export function launch(): Promise<Browser> {
  return chromium.launch({ executablePath: process.env["CHROMIUM"] ?? "/usr/bin/chromium", args: kFlags });
}

/** Opens the page; errors of its scripts fail the test when they are read. */
export async function open(browser: Browser, url: string, prepare?: (page: Page) => Promise<void>, viewport = { width: 1280, height: 800 }): Promise<{ page: Page; errors: string[] }> {
  const page = await browser.newPage({ viewport });
  page.setDefaultTimeout(90_000);
  const errors: string[] = [];
  page.on("pageerror", (error) => errors.push(error.stack ?? error.message));
  page.on("console", (message) => message.type() === "error" && !message.text().includes("WebSocket") && errors.push(message.text()));
  await prepare?.(page);
  await page.goto(url);
  return { page, errors };
}

/** What tests see of the page. */
export interface Concord {
  layers: { settled: boolean; triangles: number };
}

export async function settled(page: Page, triangles = 1): Promise<void> {
  await page.waitForFunction((least) => {
    const { concord } = window as unknown as { concord?: Concord };
    return concord !== undefined && concord.layers.settled && concord.layers.triangles >= least;
  }, triangles, { timeout: 60_000 });
  await nextFrames(page);
}

/** Lets what is pending be drawn. */
export function nextFrames(page: Page): Promise<void> {
  return page.evaluate(() => new Promise<void>((resolve) => requestAnimationFrame(() => requestAnimationFrame(() => resolve()))));
}

/** The canvas alone. */
export async function canvasShot(page: Page, name: string): Promise<void> {
  const url = await page.evaluate(() => document.querySelector<HTMLCanvasElement>("#canvas")!.toDataURL("image/png"));
  save(name, Buffer.from(url.slice(url.indexOf(",") + 1), "base64"));
}

/** The whole page, with its panels. */
export async function pageShot(page: Page, name: string): Promise<void> {
  save(name, await page.screenshot());
}

function save(name: string, bytes: Buffer): void {
  const file = join(shots, `${name}.png`);
  mkdirSync(dirname(file), { recursive: true });
  writeFileSync(file, bytes);
}
