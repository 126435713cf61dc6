/** Where things are, for tests that run from the build folder. */
import { join } from "node:path";

const top = process.env["CONCORD_TOP"];
if (!top) throw new Error("CONCORD_TOP must name the top of the checkout");
export const nativeClient = join(top, "hmd_bridge/examples/native_client.py");
export const goldenFolder = join(top, "hmd_bridge/protocol/golden");
export const capturesFolder = join(top, "hmd_bridge/web/node_modules/@iwer/sem/captures");
