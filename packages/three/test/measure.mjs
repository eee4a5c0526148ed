// Times of a frame as ratios to three.js's weighted OIT, in one run: `npm run measure`. Other programs disturb times on the wall;
// where the system tells it (Linux), the processor time of the browser's drawing process is measured, too.

import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { cpus } from 'node:os';
import { join } from 'node:path';
import { PACKAGE, open } from './browser.mjs';

// Linux counts in hundredths of a second.
const TICK_MS = 10;

// The browser's process that draws, among its descendants.
function drawingProcess( root ) {

	if ( existsSync( '/proc/self/stat' ) === false ) return null;

	const processes = execFileSync( 'ps', [ '-eo', 'pid=,ppid=,args=' ], { encoding: 'utf8' } ).split( '\n' ).map( ( line ) => line.trim().match( /^(\d+) +(\d+) (.*)$/ ) ).filter( Boolean );
	const family = new Set( [ String( root ) ] );

	// Processes are listed in any order, so the family grows until it stays.
	for ( let size = 0; size !== family.size; ) {

		size = family.size;
		processes.forEach( ( [ , pid, parent ] ) => family.has( parent ) && family.add( pid ) );

	}

	return processes.find( ( [ , pid, , args ] ) => family.has( pid ) && args.includes( '--type=gpu-process' ) )?.[ 1 ] ?? null;

}

const browser = await open();
const pid = drawingProcess( browser.browser.process().pid );

await browser.page.exposeFunction( 'processorTime', () => {

	if ( pid === null ) return null;

	const fields = readFileSync( `/proc/${ pid }/stat`, 'utf8' ).split( ') ' ).at( - 1 ).split( ' ' );

	return TICK_MS * ( Number( fields[ 11 ] ) + Number( fields[ 12 ] ) );

} );

const { three } = await browser.run( 'versions', 'webgpu' );
const result = { three, browser: browser.version, processor: cpus()[ 0 ].model, cores: cpus().length, runs: {}, threads: {} };
const options = { models: ( process.env.PEELNET_MODELS ?? 'small,medium,large,anchored-small,one' ).split( ',' ), ranges: ( process.env.PEELNET_RANGES ?? 'pixel,frame' ).split( ',' ), rounds: Number( process.env.PEELNET_ROUNDS ?? 5 ), frames: 3, requiredLimits: JSON.parse( process.env.PEELNET_LIMITS ?? '{}' ) };

for ( const backend of [ 'webgpu', 'webgl2' ] ) {

	result.runs[ backend ] = await browser.run( 'timed', backend, options );
	result.threads[ backend ] = { ...await browser.run( 'mainThread', backend ), 'first frame': await browser.run( 'afterCompiling', backend ) };
	console.log( backend );
	console.table( result.runs[ backend ] );
	console.table( result.threads[ backend ] );

}

await browser.close();
mkdirSync( join( PACKAGE, 'out' ), { recursive: true } );
writeFileSync( join( PACKAGE, 'out/measured.json' ), JSON.stringify( result, null, '\t' ) + '\n' );
console.log( `three.js r${ three }, ${ result.browser }, ${ result.processor }, ${ result.cores } cores; out/measured.json` );
