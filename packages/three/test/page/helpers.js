// What the cases share.

import { peelnetPass } from '@peelnet/three';
import { HEIGHT, WIDTH, imageOf } from './measure.js';

export const modelOf = async ( name ) => ( await import( `@peelnet/three/models/${ name }.js` ) ).default;

export const aspect = WIDTH / HEIGHT;

/** What a drawing makes with a property of an object replaced. */
export const replaced = async ( object, name, value, draw ) => {

	const kept = Object.getOwnPropertyDescriptor( object, name );

	Object.defineProperty( object, name, { value, configurable: true, writable: true } );

	const made = await draw();

	if ( kept === undefined ) delete object[ name ];
	else Object.defineProperty( object, name, kept );

	return made;

};

/** An image of a new pass, the pass, and what it had to say. */
export const drawn = async ( renderer, scene, camera, options, frames ) => {

	const problems = [];
	const node = peelnetPass( scene, camera, { onProblem: ( message ) => problems.push( message ), ...options } );
	const image = await imageOf( renderer, node, frames );

	return { image, node, problems };

};
