// The scenes of the tests and of the example. No two surfaces are coplanar: their order would be nobody's.

import * as THREE from 'three/webgpu';

/** Random numbers in [0, 1) that are the same in every browser (a linear congruential generator). */
export function random( seed ) {

	let state = seed >>> 0;

	return () => {

		state = ( Math.imul( state, 1664525 ) + 1013904223 ) >>> 0;

		return state / 4294967296;

	};

}

export function perspective( aspect ) {

	const camera = new THREE.PerspectiveCamera( 40, aspect, 0.1, 100 );

	camera.position.set( 0, 1.2, 7 );
	camera.lookAt( 0, 0.2, 0 );

	return camera;

}

export function orthographic( aspect ) {

	const camera = new THREE.OrthographicCamera( - 2.4 * aspect, 2.4 * aspect, 2.4, - 2.4, 0.1, 100 );

	camera.position.set( 0, 1.2, 7 );
	camera.lookAt( 0, 0.2, 0 );

	return camera;

}

export function lights( scene ) {

	const sun = new THREE.DirectionalLight( 0xffffff, 2 );

	sun.position.set( 2, 4, 3 );
	scene.add( sun, new THREE.AmbientLight( 0xffffff, 0.8 ) );

	return scene;

}

/** Two cards without light, one behind the other: what they show can be computed by hand. */
export function twoCards( { near = { color: 0xff4020, opacity: 0.6 }, far = { color: 0x2040ff, opacity: 0.7 } } = {} ) {

	const scene = new THREE.Scene();

	scene.background = new THREE.Color( 0x808080 );

	// The near one first, so that drawing in the scene's order would be wrong.
	for ( const [ z, x, material ] of [ [ 0.5, 0.2, near ], [ - 0.5, - 0.2, far ] ] ) {

		const card = new THREE.Mesh( new THREE.PlaneGeometry( 2, 2 ), new THREE.MeshBasicMaterial( { ...material, transparent: true, side: THREE.DoubleSide } ) );

		card.position.set( x, 0.2, z );
		scene.add( card );

	}

	return scene;

}

/** 25 double-sided spheres and 25 cards that pass through one another, over an opaque floor and around an opaque pillar. */
export function fifty( { alphaMap = null } = {} ) {

	const scene = lights( new THREE.Scene() );
	const next = random( 7 );
	const between = ( low, high ) => low + ( high - low ) * next();
	const sphere = new THREE.SphereGeometry( 1, 24, 16 );
	const card = new THREE.PlaneGeometry( 1, 1 );

	scene.background = new THREE.Color( 0x30343c );

	const floor = new THREE.Mesh( new THREE.PlaneGeometry( 8, 8 ), new THREE.MeshStandardMaterial( { color: 0x9a968c } ) );

	floor.rotation.x = - Math.PI / 2;
	floor.position.y = - 1.4;

	const pillar = new THREE.Mesh( new THREE.CylinderGeometry( 0.25, 0.25, 3.2, 24 ), new THREE.MeshStandardMaterial( { color: 0xd8d0c0 } ) );

	pillar.position.y = 0.2;
	scene.add( floor, pillar );

	for ( let i = 0; i < 50; i ++ ) {

		const isSphere = i < 25;
		const material = new THREE.MeshStandardMaterial( { transparent: true, opacity: between( 0.2, 0.8 ), side: THREE.DoubleSide, roughness: 0.6, alphaMap: isSphere ? null : alphaMap } );

		material.color.setHSL( next(), between( 0.5, 0.9 ), between( 0.35, 0.65 ) );

		const mesh = new THREE.Mesh( isSphere ? sphere : card, material );

		mesh.scale.setScalar( isSphere ? between( 0.25, 0.6 ) : between( 0.7, 1.5 ) );
		mesh.position.set( between( - 2, 2 ), between( - 1, 1.6 ), between( - 2, 2 ) );
		mesh.rotation.set( between( - 0.6, 0.6 ), between( - 1, 1 ), between( 0, 3 ) );
		scene.add( mesh );

	}

	return scene;

}

// A texture of soft blobs: opacity in every channel, as alpha maps read green.
function blobs( size = 64 ) {

	const data = new Uint8Array( 4 * size * size );

	for ( let y = 0; y < size; y ++ ) {

		for ( let x = 0; x < size; x ++ ) {

			const v = 127.5 + 127.5 * Math.sin( x * 0.35 ) * Math.cos( y * 0.25 );

			data.set( [ v, v, v, 255 ], 4 * ( y * size + x ) );

		}

	}

	const texture = new THREE.DataTexture( data, size, size );

	texture.magFilter = THREE.LinearFilter;
	texture.minFilter = THREE.LinearFilter;
	texture.needsUpdate = true;

	return texture;

}

export function skinned() {

	// A strip of four segments along y; its two bones bend it towards the camera.
	const geometry = new THREE.PlaneGeometry( 0.8, 2, 1, 4 );
	const { position } = geometry.attributes;
	const indices = [];
	const weights = [];

	for ( let i = 0; i < position.count; i ++ ) {

		const upper = ( position.getY( i ) + 1 ) / 2;

		indices.push( 0, 1, 0, 0 );
		weights.push( 1 - upper, upper, 0, 0 );

	}

	geometry.setAttribute( 'skinIndex', new THREE.Uint16BufferAttribute( indices, 4 ) );
	geometry.setAttribute( 'skinWeight', new THREE.Float32BufferAttribute( weights, 4 ) );

	const bones = [ new THREE.Bone(), new THREE.Bone() ];

	bones[ 0 ].add( bones[ 1 ] );

	const mesh = new THREE.SkinnedMesh( geometry, new THREE.MeshStandardMaterial( { color: 0x60c040, transparent: true, opacity: 0.6, side: THREE.DoubleSide } ) );

	mesh.add( bones[ 0 ] );
	mesh.bind( new THREE.Skeleton( bones ) );
	bones[ 1 ].rotation.x = 1.2;
	mesh.position.set( 0.9, 0.4, 0.1 );

	return mesh;

}

/** Instances, a batch, a skinned mesh, alpha maps, vertex opacities, alpha tests and sprites between one another, in fog. */
export function mixed() {

	const scene = fifty( { alphaMap: blobs() } );
	const next = random( 11 );
	const matrix = new THREE.Matrix4();
	const instances = new THREE.InstancedMesh( new THREE.PlaneGeometry( 0.5, 0.5 ), new THREE.MeshStandardMaterial( { transparent: true, opacity: 0.45, side: THREE.DoubleSide } ), 20 );

	for ( let i = 0; i < instances.count; i ++ ) {

		matrix.makeRotationY( next() * 2 - 1 ).setPosition( next() * 4 - 2, next() * 2.4 - 1, next() * 4 - 2 );
		instances.setMatrixAt( i, matrix );
		instances.setColorAt( i, new THREE.Color().setHSL( next(), 0.8, 0.5 ) );

	}

	const faded = new THREE.PlaneGeometry( 1.5, 1.5 );

	faded.setAttribute( 'color', new THREE.Float32BufferAttribute( [ 1, 0, 0, 0.9, 0, 1, 0, 0.2, 0, 0, 1, 0.5, 1, 1, 1, 0.7 ], 4 ) );

	const veil = new THREE.Mesh( faded, new THREE.MeshBasicMaterial( { vertexColors: true, transparent: true, side: THREE.DoubleSide } ) );

	veil.position.set( - 0.8, 0.5, 1.31 );

	const tested = new THREE.Mesh( new THREE.PlaneGeometry( 1.5, 1.5 ), new THREE.MeshBasicMaterial( { color: 0xffd020, alphaMap: blobs(), alphaTest: 0.4, transparent: true, side: THREE.DoubleSide } ) );

	tested.position.set( 0.5, - 0.3, 1.57 );

	const sprite = new THREE.Sprite( new THREE.SpriteMaterial( { color: 0x40e0ff, opacity: 0.5 } ) );

	sprite.position.set( - 0.4, 0.9, 0.83 );

	const batch = new THREE.BatchedMesh( 2, 8, 12, new THREE.MeshStandardMaterial( { color: 0xe080a0, transparent: true, opacity: 0.5, side: THREE.DoubleSide } ) );
	const part = batch.addGeometry( new THREE.PlaneGeometry( 0.9, 0.9 ) );

	for ( const x of [ - 1.3, 1.4 ] ) batch.setMatrixAt( batch.addInstance( part ), matrix.makeRotationX( 0.4 ).setPosition( x, 0.2, 1.13 ) );

	scene.add( instances, veil, tested, sprite, skinned(), batch );
	scene.fog = new THREE.Fog( 0xa0b0c0, 4, 12 );

	return scene;

}
