// SPDX-License-Identifier: BSD-3-Clause

/** A worker handles its messages one after the other; what one throws is told, and the next goes on. */
export function handleInTurn<Message>(
  handle: (message: Message) => void | Promise<void>,
  failed: (message: Message, words: string) => void,
): void {
  let queue: Promise<void> = Promise.resolve();
  self.onmessage = ({ data }: MessageEvent<Message>) => {
    queue = queue
      .then(() => handle(data))
      .catch((error: unknown) =>
        failed(data, error instanceof Error ? error.message : String(error)),
      );
  };
}
