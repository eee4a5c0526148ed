// What every page does: pictures and times of each of its peer's methods.

/**
 * `start( scene )` sets a peer up and returns its version, its canvas, with a WebGL context, and for each method a function that draws a frame of
 * `scene.glb`; the method `opaque` draws `opaque.glb`. What a frame shows is linear.
 */
export function peer( start ) {

	window.drawn = async ( scene ) => {

		const { version, canvas, methods, bytes = {} } = await start( scene );
		const gl = canvas.getContext( 'webgl2' );
		const pixels = new Uint8Array( 4 * scene.width * scene.height );

		if ( gl.drawingBufferWidth !== scene.width || gl.drawingBufferHeight !== scene.height ) throw new Error( 'The canvas has another size than the scene.' );

		// Reading the picture waits until it is drawn, as it does in the other programs.
		const frame = async ( draw ) => {

			await draw();

			const bound = gl.getParameter( gl.READ_FRAMEBUFFER_BINDING );

			gl.bindFramebuffer( gl.READ_FRAMEBUFFER, null );
			gl.readPixels( 0, 0, scene.width, scene.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels );
			gl.bindFramebuffer( gl.READ_FRAMEBUFFER, bound );

		};

		const pictures = {};
		const times = {};

		for ( const [ name, { use = () => {}, draw } ] of Object.entries( methods ) ) {

			await use();

			// The first frames compile shaders.
			for ( let i = 0; i < 3; i ++ ) await frame( draw );

			pictures[ name ] = btoa( Array.from( pixels, ( byte ) => String.fromCharCode( byte ) ).join( '' ) );

			if ( name === 'opaque' ) continue;

			const all = [];

			for ( let i = 0; i < scene.frames; i ++ ) {

				const begun = performance.now();

				await frame( draw );
				all.push( performance.now() - begun );

			}

			times[ name ] = all.sort( ( a, b ) => a - b )[ Math.floor( all.length / 2 ) ];

		}

		const info = gl.getExtension( 'WEBGL_debug_renderer_info' );

		return { version, adapter: gl.getParameter( info.UNMASKED_RENDERER_WEBGL ), times, bytes, pictures };

	};

}
