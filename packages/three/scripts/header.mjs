// The description in the header of an exported text, for exports without a model.json beside them.

const BLENDS = { ADD: 'add', MAX: 'max', 'dst * (1 - src)': 'transmit' };

const one = ( text, expression, what ) => {

	const match = text.match( expression );

	if ( match === null ) throw new Error( `The text's header has no ${ what }.` );

	return match;

};

/** The identifiers of `names` that stand in a computation. */
const readsOf = ( code, names ) => names.filter( ( name ) => new RegExp( `\\b(?<!\\.)${ name }\\b` ).test( code ) );

export function descriptionOf( text ) {

	const [ , toolVersion ] = one( text, /Exported by peelnet (\S+)\.\n/, 'version' );
	const [ , topology, parameters, recipe ] = one( text, /Network: (\S+) .*?, (\d+) parameters.*Recipe (\S+),/, 'network' );
	const [ , resolve ] = one( text, /Resolve: (.+) is the colour of the pixel/, 'resolve' );
	const passes = [];
	const names = [];

	for ( const line of text.split( '\n' ) ) {

		const pass = line.match( /^\/\/ \d\. Pass "(\w+)": draw all transparent surfaces, in any order\. ?(.*)$/ );
		const target = line.match( /^\/\/ {4}(\w+): (\w+), cleared to (.+), blending (.+), from (.+)$/ );

		if ( pass !== null ) {

			names.push( ...passes.at( - 1 )?.targets.map( ( before ) => before.name ) ?? [] );
			passes.push( { name: pass[ 1 ], reads: readsOf( pass[ 2 ], names ), compute: pass[ 2 ], targets: [] } );

		} else if ( target !== null ) {

			const [ , name, format, cleared, blend, write ] = target;
			const clear = cleared.split( ', ' ).map( Number );
			const [ , color, alpha ] = blend.match( /^(.+) for rgb, (.+) for alpha$/ ) ?? [ blend, blend, blend ];

			passes.at( - 1 ).targets.push( { name, format, clear: clear.length === 4 ? clear : Array( 4 ).fill( clear[ 0 ] ), color: BLENDS[ color ], alpha: BLENDS[ alpha ], write } );

		}

	}

	names.push( ...passes.at( - 1 ).targets.map( ( target ) => target.name ) );

	return { format: 'peelnet-export', format_version: 1, tool_version: toolVersion, recipe, parameters: Number( parameters ), topology, passes, resolve, resolve_reads: readsOf( resolve, names ) };

}
