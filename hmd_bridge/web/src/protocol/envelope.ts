/** Text frames of hmd.v1: what a server's text is, checked against the schema before anybody believes it. */
import { checkAnswer, checkEvent, checkStruct, type Answers, type Events, type Refusal } from "../../generated/messages";

export type EventMessage = { [K in keyof Events]: { event: K; body: Events[K] } }[keyof Events];
export type ServerText =
  | { what: "answer"; id: number; fields: unknown }
  | { what: "error"; id: number; refusal: Refusal }
  | ({ what: "event" } & EventMessage);

export class TextError extends Error {}

function refuse(why: string): never {
  throw new TextError(why);
}

function members(value: unknown): Record<string, unknown> {
  if (typeof value !== "object" || value === null || Array.isArray(value)) refuse("a message is no object");
  return value as Record<string, unknown>;
}

/** @throws TextError. An answer's fields are checked by `answerTo`, which knows the request. */
export function readText(text: string): ServerText {
  let json: unknown;
  try {
    json = JSON.parse(text);
  } catch {
    refuse("a message is no JSON");
  }
  const message = members(json);
  if (typeof message["event"] === "string") {
    const problem = checkEvent(message["event"], message["body"]);
    if (problem) refuse(problem);
    return { what: "event", event: message["event"], body: message["body"] } as ServerText;
  }
  const id = message["id"];
  if (!Number.isSafeInteger(id)) refuse("a message has neither an event nor an id");
  if ("answer" in message) return { what: "answer", id: id as number, fields: message["answer"] };
  const problem = checkStruct("Refusal", message["error"]);
  if (problem) refuse(problem);
  return { what: "error", id: id as number, refusal: message["error"] as Refusal };
}

/** @throws TextError */
export function answerTo<K extends keyof Answers>(request: K, fields: unknown): Answers[K] {
  const problem = checkAnswer(request, fields);
  if (problem) refuse(problem);
  return fields as Answers[K];
}
