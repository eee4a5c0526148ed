/** Positions, triangles, linear colour and opacity of every mesh, for a peer that reads no GLB; only what transparency.py writes. */
export async function meshes( url ) {

	const file = await ( await fetch( url ) ).arrayBuffer();
	const length = new DataView( file ).getUint32( 12, true );
	const gltf = JSON.parse( new TextDecoder().decode( new Uint8Array( file, 20, length ) ) );
	const values = ( index, Kind, width ) => {

		const { bufferView, count } = gltf.accessors[ index ];

		return new Kind( file, 28 + length + gltf.bufferViews[ bufferView ].byteOffset, width * count );

	};

	return gltf.meshes.map( ( { primitives: [ { attributes, indices, material } ] } ) => {

		const [ red, green, blue, alpha ] = gltf.materials[ material ].pbrMetallicRoughness.baseColorFactor;

		return { points: values( attributes.POSITION, Float32Array, 3 ), triangles: values( indices, Uint32Array, 1 ), color: [ red, green, blue ], alpha };

	} );

}
