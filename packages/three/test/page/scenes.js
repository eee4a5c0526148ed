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
