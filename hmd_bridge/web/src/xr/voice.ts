/** Spoken commands, where the browser knows how to listen. */
interface Recognition {
  continuous: boolean;
  lang: string;
  onresult: ((event: { results: ArrayLike<ArrayLike<{ transcript: string }>> }) => void) | null;
  onend: (() => void) | null;
  start(): void;
  stop(): void;
}
type RecognitionClass = new () => Recognition;

function recognitionClass(): RecognitionClass | undefined {
  const { SpeechRecognition, webkitSpeechRecognition } = window as unknown as Record<string, RecognitionClass | undefined>;
  return SpeechRecognition ?? webkitSpeechRecognition;
}

export const canListen = (): boolean => recognitionClass() !== undefined;

/** The command that was said, whatever stands around it. */
export function commandIn<T>(said: string, commands: Readonly<Record<string, T>>): T | undefined {
  const words = said.toLowerCase().replace(/[^a-z ]/g, " ").replace(/ +/g, " ");
  return Object.entries(commands).find(([phrase]) => words.includes(phrase))?.[1];
}

/** Listens until the answer is called. */
export function listen(commands: Readonly<Record<string, () => void>>): () => void {
  const recognition = new (recognitionClass()!)();
  let on = true;
  recognition.continuous = true;
  recognition.lang = "en";
  recognition.onresult = ({ results }) => {
    const said = results[results.length - 1]?.[0]?.transcript ?? "";
    commandIn(said, commands)?.();
  };
  recognition.onend = () => {
    if (on) recognition.start(); // browsers stop by themselves after a silence
  };
  recognition.start();
  return () => {
    on = false;
    recognition.stop();
  };
}
