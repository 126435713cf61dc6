/** The real stack with its bridge, in the present network, on a state of its own. */
import { execFile, spawn, type ChildProcess } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { promisify } from "node:util";

const build = process.env["CONCORD_BUILD"];
if (!build) throw new Error("CONCORD_BUILD must name the build folder");
const concord = join(build, "bin/concord");

export class Stack {
  private constructor(
    private readonly folder: string,
    private readonly up: ChildProcess,
    /** Of the bridge, for a browser. */
    readonly url: string,
  ) {}

  /** Begins with an empty state, or with the saved maps of another stack. */
  static async start(resolution: number): Promise<Stack> {
    const folder = mkdtempSync(join(tmpdir(), "concord-web-"));
    const site = join(folder, "site.yaml");
    writeFileSync(site, `state: ${folder}/state
resolution: ${resolution}
agents: {unlisted: {kind: headset, radius: 0.18}, robot1: {kind: lidar, radius: 0.18}}
planner: {zmin: 0.3, zmax: 1.1}
bridge: {port: 0, local_role: robot}
`);
    const up = spawn(concord, ["--site", site, "up"], { stdio: ["ignore", "pipe", "pipe"] });
    const url = await new Promise<string>((found, failed) => {
      let said = "";
      const hear = (text: Buffer): void => {
        said += text.toString();
        const address = /open (http:\S+) in a browser/.exec(said);
        if (address) found(address[1]!);
      };
      up.stdout.on("data", hear);
      up.stderr.on("data", hear);
      up.on("exit", () => failed(new Error(`the stack did not start:\n${said}`)));
    });
    return new Stack(folder, up, url);
  }

  /** What a command of the client prints. */
  async concord(...args: string[]): Promise<string> {
    const { stdout } = await promisify(execFile)(concord, ["--site", join(this.folder, "site.yaml"), ...args]);
    return stdout;
  }

  async stop(): Promise<void> {
    const ended = new Promise((done) => this.up.once("exit", done));
    this.up.kill("SIGTERM");
    await ended;
    rmSync(this.folder, { recursive: true });
  }
}
