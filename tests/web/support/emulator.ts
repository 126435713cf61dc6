/** Runs in the page before its own scripts: a Quest 3 that does not exist, in the captured room that `concordRoom` holds. */
import { SyntheticEnvironmentModule } from "@iwer/sem";
import { metaQuest3, XRDevice } from "iwer";

const room = (window as unknown as { concordRoom: Parameters<SyntheticEnvironmentModule["loadEnvironment"]>[0] }).concordRoom;
const device = new XRDevice(metaQuest3, { stereoEnabled: false });
device.installRuntime({ forceInstall: true });
device.installSEM(SyntheticEnvironmentModule);
device.sem!.loadEnvironment(room);
device.position.set(0, 1.65, 0);
Object.assign(window, { xrDevice: device });
