// What every page does: the picture and the time of a frame of one of its peer's methods.

/**
 * `methods` are functions by name, which take the scene and set a method up: a canvas with a WebGL 2 context, and a function that draws a frame of
 * `scene.glb`; `opaque` draws `opaque.glb`. What a frame shows is linear. Each is set up in a page of its own.
 */
export function peer( methods ) {

	window.methods = Object.keys( methods );

	window.drawn = async ( scene, method ) => {

		const { canvas, draw } = await methods[ method ]( scene );
		const gl = canvas.getContext( 'webgl2' );

		if ( gl.drawingBufferWidth !== scene.width || gl.drawingBufferHeight !== scene.height ) throw new Error( 'The canvas has another size than the scene.' );

		const pixels = new Uint8Array( 4 * scene.width * scene.height );
		const times = [];

		// The first frames compile shaders.
		for ( let i = - 3; i < scene.frames; i ++ ) {

			const begun = performance.now();

			draw();

			// Reading the picture waits until it is drawn, as it does in the other programs.
			const bound = gl.getParameter( gl.READ_FRAMEBUFFER_BINDING );

			gl.bindFramebuffer( gl.READ_FRAMEBUFFER, null );
			gl.readPixels( 0, 0, scene.width, scene.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels );
			gl.bindFramebuffer( gl.READ_FRAMEBUFFER, bound );

			if ( i >= 0 ) times.push( performance.now() - begun );

		}

		return {
			adapter: gl.getParameter( gl.getExtension( 'WEBGL_debug_renderer_info' ).UNMASKED_RENDERER_WEBGL ),
			ms: times.sort( ( a, b ) => a - b )[ Math.floor( times.length / 2 ) ],
			picture: btoa( Array.from( pixels, ( byte ) => String.fromCharCode( byte ) ).join( '' ) )
		};

	};

}
