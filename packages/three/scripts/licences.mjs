// Copies the repository's licences beside package.json, so that `npm pack` puts them into the package.

import { copyFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const PACKAGE = dirname( dirname( fileURLToPath( import.meta.url ) ) );

for ( const name of [ 'LICENSE-MIT', 'LICENSE-APACHE' ] ) copyFileSync( join( PACKAGE, '../..', name ), join( PACKAGE, name ) );
