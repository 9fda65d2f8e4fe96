// SPDX-License-Identifier: Apache-2.0
// What a client in JavaScript needs to open a session and read its first messages: in a browser or with npm's ws.
"use strict";

// Messages of protocol/vectors/v1, built by hand: a FlatBuffer with root Message {body_type, body}.
const HELLO = 1, GET_CATALOGUE = 2, OPEN = 3, WELCOME = 8, CATALOGUE = 9, MODEL_INFO = 10, BASE = 11;

/** The type of a message, and its body as a table to read fields from. */
function decode(buffer) {
  const view = new DataView(buffer);
  const table = (at) => ({
    // Where field `index` is; 0 when absent.
    field(index) {
      const vtable = at - view.getInt32(at, true);
      const slot = 4 + 2 * index;
      if (slot >= view.getUint16(vtable, true)) return 0;
      const offset = view.getUint16(vtable + slot, true);
      return offset ? at + offset : 0;
    },
    text(index) {
      let from = this.field(index);
      if (!from) return "";
      from += view.getUint32(from, true);
      return new TextDecoder().decode(new Uint8Array(buffer, from + 4, view.getUint32(from, true)));
    },
    bytes(index) {
      let from = this.field(index);
      if (!from) return 0;
      from += view.getUint32(from, true);
      return view.getUint32(from, true);
    },
  });
  const identifier = String.fromCharCode(...new Uint8Array(buffer, 4, 4));
  if (identifier !== "LIMN") throw new Error("no LIMN message");
  const root = table(view.getUint32(0, true));
  const body = root.field(1);
  return {type: view.getUint8(root.field(0)), body: table(body + view.getUint32(body, true))};
}

/** Opens a model and resolves with what came: {server, model, baseBytes}. vectors: messages by name. */
function talk(socket, vectors) {
  const seen = {};
  socket.binaryType = "arraybuffer";
  return new Promise((resolve, reject) => {
    socket.onerror = (event) => reject(new Error(event.message || "the connection failed"));
    socket.onclose = (event) => reject(new Error("closed with " + event.code + " " + event.reason));
    socket.onopen = () => socket.send(vectors.hello);
    socket.onmessage = (event) => {
      try {
        const {type, body} = decode(event.data);
        if (type === WELCOME) {
          seen.server = body.text(1);
          socket.send(vectors.get_catalogue);
        } else if (type === CATALOGUE) {
          seen.catalogueBytes = event.data.byteLength;
          socket.send(vectors.open);
        } else if (type === MODEL_INFO) {
          seen.model = body.text(1);
        } else if (type === BASE) {
          seen.baseBytes = event.data.byteLength;
          seen.protocol = socket.protocol;
          resolve(seen);
        } else {
          reject(new Error("message of type " + type));
        }
      } catch (error) {
        reject(error);
      }
    };
  });
}

if (typeof module !== "undefined") {
  module.exports = {decode, talk};
  if (require.main === module) {
    // node limn_peer.js URL VECTORS.json, messages in base64
    const WebSocket = require("ws");
    const [url, file] = process.argv.slice(2);
    const vectors = Object.fromEntries(Object.entries(JSON.parse(require("fs").readFileSync(file, "utf8")))
        .map(([name, text]) => [name, Buffer.from(text, "base64")]));
    talk(new WebSocket(url, "limn.1"), vectors).then((seen) => {
      console.log(JSON.stringify(seen));
      process.exit(0);
    }, (error) => {
      console.error(error.message);
      process.exit(1);
    });
  }
}
