// Files that the tests drop.

/** A GLB file of one half transparent square. */
export function square() {
  const vertices = new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]);
  const indices = new Uint16Array([0, 1, 2, 0, 2, 3]);
  const json = {
    asset: { version: '2.0' },
    scene: 0,
    scenes: [{ nodes: [0] }],
    nodes: [{ mesh: 0, name: 'square' }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1, material: 0 }] }],
    materials: [{ pbrMetallicRoughness: { baseColorFactor: [0.9, 0.2, 0.1, 0.5] }, alphaMode: 'BLEND', doubleSided: true }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 4, type: 'VEC3', min: [-1, -1, 0], max: [1, 1, 0] },
      { bufferView: 1, componentType: 5123, count: 6, type: 'SCALAR' }
    ],
    bufferViews: [{ buffer: 0, byteOffset: 0, byteLength: 48 }, { buffer: 0, byteOffset: 48, byteLength: 12 }],
    buffers: [{ byteLength: 60 }]
  };
  const text = Buffer.from(JSON.stringify(json));
  const chunk = (kind, bytes, pad) => {
    const length = Math.ceil(bytes.length / 4) * 4;
    const out = Buffer.alloc(8 + length, pad);
    out.writeUInt32LE(length, 0);
    out.writeUInt32LE(kind, 4);
    bytes.copy(out, 8);
    return out;
  };
  const body = Buffer.concat([chunk(0x4e4f534a, text, 0x20), chunk(0x004e4942, Buffer.concat([Buffer.from(vertices.buffer), Buffer.from(indices.buffer)]), 0)]);
  const head = Buffer.alloc(12);
  head.writeUInt32LE(0x46546c67, 0);
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(12 + body.length, 8);
  return Buffer.concat([head, body]);
}

/** A square as OBJ, with the materials of a file that is not there. */
export const OBJ = 'mtllib square.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3 4/4\n';
