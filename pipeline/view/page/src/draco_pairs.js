// Which labels the triangles of a .drc separate: voxweld writes them as metadata of an attribute,
// which three's decoder does not hand out.
// Based on: Google, "Draco Bitstream Specification" (2.2), sections "Draco Header" and "Metadata".

const entry_name = "voxweld_label_pairs";
const header_bytes = 11, has_metadata = 0x8000;

class Reader {
  constructor(buffer, at) {
    this.bytes = new Uint8Array(buffer);
    this.at = at;
  }
  byte() {
    if (this.at >= this.bytes.length) throw new Error("the file ends within its metadata");
    return this.bytes[this.at++];
  }
  varint() {
    let value = 0, scale = 1;
    for (;;) {
      const byte = this.byte();
      value += (byte & 127) * scale;
      if (byte < 128) return value;
      scale *= 128;
    }
  }
  text(length) {
    const text = new TextDecoder().decode(this.bytes.subarray(this.at, this.at + length));
    this.at += length;
    return text;
  }
}

function read_entries(reader, found) {
  for (let count = reader.varint(); count > 0; --count) {
    const name = reader.text(reader.byte());
    const value = reader.text(reader.varint());
    if (name === entry_name) found.text = value;
  }
  for (let count = reader.varint(); count > 0; --count) {
    reader.text(reader.byte());
    read_entries(reader, found);
  }
}

// [{inside, outside}], labels as text and null for what is around the volume; or null where the file
// names none.
export function draco_pairs(buffer) {
  if (buffer.byteLength < header_bytes) return null;
  const flags = new DataView(buffer).getUint16(9, true);
  if ((flags & has_metadata) === 0) return null;
  const reader = new Reader(buffer, header_bytes), found = {};
  for (let count = reader.varint(); count > 0; --count) {
    reader.varint();
    read_entries(reader, found);
  }
  if (found.text === undefined) return null;
  const label = (text) => (text === "-" ? null : text);
  return found.text.split(";").filter(Boolean).map((pair) => {
    const [inside, outside] = pair.split(",");
    return { inside: label(inside), outside: label(outside) };
  });
}
