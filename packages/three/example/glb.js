// A GLB from the user's disk, checked before a loader sees it.

import { Box3, Color, DirectionalLight, AmbientLight, Scene, Vector3 } from 'three/webgpu';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

// "glTF", as the first four bytes of a GLB.
const MAGIC = 0x46546c67;
const HEADER_BYTES = 12;

/** What is wrong with a file that should be a GLB, as one sentence, or null. */
export function glbProblem( bytes ) {

	if ( bytes.byteLength < HEADER_BYTES ) return 'The file is no GLB: it is too short.';

	const view = new DataView( bytes );

	if ( view.getUint32( 0, true ) !== MAGIC ) return 'The file is no GLB: it does not begin with "glTF".';
	if ( view.getUint32( 4, true ) !== 2 ) return `The file is a GLB of version ${ view.getUint32( 4, true ) }; version 2 is read.`;
	if ( view.getUint32( 8, true ) !== bytes.byteLength ) return 'The GLB is damaged: its length is not the one it names.';

	return null;

}

/** The scene of a GLB in a box of the example's size, or an error with one sentence. */
export async function sceneOf( bytes ) {

	const problem = glbProblem( bytes );

	if ( problem !== null ) throw new Error( problem );

	const gltf = await new GLTFLoader().parseAsync( bytes, '' ).catch( () => {

		throw new Error( 'The GLB cannot be read: its content is not valid glTF, or needs a decoder that this page lacks.' );

	} );

	const box = new Box3().setFromObject( gltf.scene );
	const size = box.getSize( new Vector3() );
	const scale = 4 / Math.max( size.x, size.y, size.z, 1e-6 );

	gltf.scene.scale.multiplyScalar( scale );
	gltf.scene.position.sub( box.getCenter( new Vector3() ).multiplyScalar( scale ) );

	const scene = new Scene();
	const sun = new DirectionalLight( 0xffffff, 2 );

	sun.position.set( 2, 4, 3 );
	scene.background = new Color( 0x30343c );
	scene.add( gltf.scene, sun, new AmbientLight( 0xffffff, 0.8 ) );

	return scene;

}
