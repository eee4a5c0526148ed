// What the cases share.

import { peelnetPass } from '@peelnet/three';
import { HEIGHT, WIDTH, imageOf } from './measure.js';

export const modelOf = async ( name ) => ( await import( `@peelnet/three/models/${ name }.js` ) ).default;

export const aspect = WIDTH / HEIGHT;

/** An image of a new pass, the pass, and what it had to say. */
export const drawn = async ( renderer, scene, camera, options, frames ) => {

	const problems = [];
	const node = peelnetPass( scene, camera, { onProblem: ( message ) => problems.push( message ), ...options } );
	const image = await imageOf( renderer, node, frames );

	return { image, node, problems };

};
