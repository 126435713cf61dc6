/** What a refusal means to a person, and what to do about it. The server's own message says more; both are shown. */
import type { Code, Refusal } from "../../generated/messages";

export class RefusedError extends Error {
  constructor(readonly refusal: Refusal) {
    super(sayRefusal(refusal));
  }
}

const kWords: Record<Code, string> = {
  BAD_MESSAGE: "The server did not understand this page. Reload it.",
  BAD_TOKEN: "This token is not valid. Ask whoever runs the server for one: concord token add NAME --role ROLE.",
  VERSION: "This page and the server are of different versions. Reload the page.",
  BAD_REQUEST: "Something in this request cannot be.",
  DENIED: "Your role does not allow this.",
  RATE: "Too many requests. Wait a moment.",
  TIMEOUT: "No answer came in time. It may have been done all the same: see History.",
  BAD_FRAME: "The map of this device began anew. Place it again.",
  TOO_LARGE: "This is too large to send. Take a smaller part.",
  BUSY: "The server is busy. Try again in a moment.",
  TRACKING_LOST: "The headset does not know where it is. Look around slowly.",
  DUP_SEQ: "The server already has this part of the room.",
  RES_MISMATCH: "The map has another voxel size.",
  EMPTY: "There is nothing there.",
  NO_AGENT: "This agent is not here any more.",
  NO_MAP: "There is no map yet.",
  LOW_OVERLAP: "The two maps hardly overlap there. Place them closer, or scan more of what both see.",
  DIVERGED: "No good fit was found near this place. Place it closer by hand and try again.",
  DEGENERATE: "What both see does not pin it down, like a bare corridor. Scan more of the room.",
  AMBIGUOUS: "It fits in several places. Place it roughly by hand first.",
  EXPIRED: "This offer is no longer open.",
  NO_MODEL: "There is no model of this robot.",
  UNALIGNED: "What this is about has no place in the common map yet.",
  STALE_REV: "Somebody else changed this meanwhile. Look again, then repeat it.",
  LOCKED: "Somebody else is working here.",
  OUT_OF_BOUNDS: "This lies outside of the map.",
  COLLISION: "Something is already where this would go.",
  CONFLICT: "Later changes stand in the way. Undo those first.",
  NO_ASSET: "There is no such asset.",
  LOW_SCORE: "The detector is not sure enough.",
  NO_INSTANCE: "This thing is not here any more.",
  BAD_NAME: "This name cannot be used.",
  NO_LABEL: "There is no such label.",
  BAD_SHAPE: "This shape cannot be used. Draw it again.",
  STALE_STAMP: "This was seen too long ago. Look at the robot again.",
  REJECTED: "Where the robot was seen is too uncertain.",
  NO_ROBOT: "There is no such robot.",
  STALE: "Nothing was heard of this robot for a while.",
  NO_PATH: "This would leave a robot without a way.",
  ROBOT_INSIDE: "A robot stands there.",
  UNREACHABLE: "There is no way to this place.",
  EXISTS: "This name is taken.",
  IO: "The server could not write or read its disk.",
  NOT_FOUND: "It is not there any more.",
  CORRUPT: "The file is damaged.",
  UNAVAILABLE: "The process that does this is not running.",
};

export const wordsFor = (code: Code): string => kWords[code];

export const sayRefusal = ({ code, message }: Pick<Refusal, "code" | "message">): string =>
  message === "" ? wordsFor(code) : `${wordsFor(code)} (${message})`;

/** For a message to a person, whatever went wrong. */
export function explain(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
