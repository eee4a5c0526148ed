//! What is written comes back, with the same bytes however it was written.

use super::*;
use std::collections::BTreeSet;

#[test]
fn rows_come_back_bit_for_bit() {
    let mut expected = FragmentBatch::default();
    for rows in (0..4).map(rows_of) {
        expected.extend_from(&rows, 0..rows.len());
    }
    for format in Format::ALL {
        let folder = temporary();
        let manifest = write_by(folder.path(), header(format), 333).unwrap();
        let dataset = Dataset::open(folder.path()).unwrap();
        assert_eq!(dataset.manifest(), &manifest);
        dataset.verify().unwrap();
        assert_eq!(dataset.rows(), expected.len() as u64);
        assert_eq!(manifest.pixels, 2501);
        for rows_per_batch in [1, 7, 1000, usize::MAX] {
            let mut found = FragmentBatch::default();
            for batch in dataset.batches(rows_per_batch) {
                let batch = batch.unwrap();
                // Whole pixels: all rows that say n are there.
                for pixel in batch.pixels() {
                    assert_eq!(batch.fragment_count[pixel.start] as usize, pixel.len());
                }
                assert!(rows_per_batch != 1000 || batch.len() <= 1000 + 12);
                found.extend_from(&batch, 0..batch.len());
            }
            assert_eq!(bits(&found), bits(&expected), "{format} {rows_per_batch}");
        }
        let [far, view, t] = [Column::Far, Column::View, Column::Transmittance];
        let columns = dataset.read_columns(&[far, view, t, view]).unwrap();
        for column in [far, view, t] {
            assert_eq!(columns.column(column), expected.column(column), "{format}");
        }
        assert!(columns.is_empty(), "nothing else is read");
        let mut views = BTreeSet::new();
        let is_trained = |p: &Part| !dataset.is_held_out(p);
        let each = |piece: &FragmentBatch| views.extend(piece.view.iter().copied());
        dataset.read_pieces(&[view], is_trained, each).unwrap();
        assert_eq!(views, [0, 1].into());
        assert!(dataset.read_columns(&[]).unwrap().is_empty());
    }
}

/// A few parts, and one of more rows than a row group and than a buffer of text. The manifest has the hash of every file.
#[test]
fn threads_and_batches_do_not_change_the_bytes() {
    let rows = view(0, 200_000, 3);
    let groups = [ROW_GROUP_ROWS, rows.len() - ROW_GROUP_ROWS].map(|n| n as u64);
    for format in Format::ALL {
        let written = |threads, batch_rows| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let (few, large) = (temporary(), temporary());
            pool.build().unwrap().install(|| {
                let few = write_by(few.path(), header(format), batch_rows).unwrap();
                [few, write_one(large.path(), format, &rows, batch_rows)]
            })
        };
        let one = written(1, usize::MAX / 2);
        assert!(format != Format::Parquet || one[1].parts[0].row_groups == groups);
        for (threads, batch_rows) in [(2, 100_001), (16, 333)] {
            assert_eq!(one, written(threads, batch_rows), "{format}, {threads}");
        }
    }
}

#[test]
fn csv_is_the_shortest_text() {
    let folder = temporary();
    let mut rows = view(0, 1, 1);
    rows.truncate(1);
    rows.one_minus_alpha[0] = 0.1;
    rows.linear_depth[0] = 16_777_216.0;
    rows.alpha_sum[0] = 0.9;
    rows.fragment_count[0] = 1;
    (rows.r[0], rows.g[0], rows.b[0]) = (1e-7, -0.0, 1.0 / 3.0);
    write_one(folder.path(), Format::Csv, &rows, 1);
    let text = fs::read_to_string(folder.path().join("fragments-00000-cups-v0.csv")).unwrap();
    let mut expected = [
        "one_minus_alpha,linear_depth,alpha_sum,fragment_count,transmittance,view,x,y,layer,r,g,b,near,far".to_owned(),
        "0.1,16777216.0,0.9,1,1.0,0,0,0,0,1e-7,-0.0,0.33333334,0.1,100.0".to_owned(),
    ];
    // Columns that came later are zero here.
    for column in &Column::ALL[14..] {
        let zero = match column.kind() {
            ColumnKind::F32 => "0.0",
            ColumnKind::U32 => "0",
        };
        expected[0] += &format!(",{}", column.name());
        expected[1] += &format!(",{zero}");
    }
    assert_eq!(text, format!("{}\n", expected.join("\n")));
}

#[test]
fn npy_arrays_are_plain_numpy() {
    use ndarray_npy::ReadNpyExt;
    let folder = temporary();
    write(folder.path(), Format::Npy).unwrap();
    let open = |column: &str| {
        let name = format!("fragments-00002-smoke-in-a-box-v0.{column}.npy");
        fs::File::open(folder.path().join(name)).unwrap()
    };
    let depth = ndarray::Array1::<f32>::read_npy(open("linear_depth")).unwrap();
    assert_eq!(depth.to_vec(), rows_of(2).linear_depth);
    let x = ndarray::Array1::<u32>::read_npy(open("x")).unwrap();
    assert_eq!(x.to_vec(), rows_of(2).x);
}

#[test]
fn sums_are_checked() {
    let folder = temporary();
    write(folder.path(), Format::Parquet).unwrap();
    let dataset = Dataset::open(folder.path()).unwrap();
    let summary = Summary::from_dataset(&dataset).unwrap();
    assert!(summary.passes(), "{:?}", summary.violations);
    assert_eq!(summary.rows, dataset.rows());
    assert_eq!(summary.pixels, dataset.manifest().pixels);
    let total = |bins: &[summary::Bin]| bins.iter().map(|b| b.count).sum::<u64>();
    assert_eq!(total(&summary.alpha), summary.rows);
    assert_eq!(total(&summary.fragments_per_pixel), summary.pixels);
    assert_eq!(summary.fragments_per_pixel.last().unwrap().to, 16.0);
    assert_eq!(summary.scenes[1].rows, rows_of(2).len() as u64);

    // Each kind of contradiction is found, in the row where it is.
    type Spoil = fn(&mut FragmentBatch, usize);
    let spoils: [(&str, Spoil); 5] = [
        ("transmittance", |rows, i| rows.transmittance[i] -= 0.001),
        ("alpha_sum", |rows, i| rows.alpha_sum[i] += 0.001),
        ("fragment_count", |rows, i| rows.fragment_count[i] += 1),
        ("layer", |rows, i| rows.layer[i] += 1),
        ("linear_depth", |rows, i| rows.linear_depth[i] = 1e-3),
    ];
    for (name, spoil) in spoils {
        let folder = temporary();
        let mut rows = view(0, 50, 1);
        let is_second = |&i: &usize| rows.layer[i] == 1 && rows.transmittance[i] > 0.1;
        let i = (0..rows.len()).find(is_second).unwrap();
        spoil(&mut rows, i);
        write_one(folder.path(), Format::Npy, &rows, 1000);
        let summary = Summary::from_dataset(&Dataset::open(folder.path()).unwrap()).unwrap();
        let found = summary.violations.iter();
        let found: Vec<_> = found.map(|v| (v.check.as_str(), v.row)).collect();
        assert_eq!(found, [(name, i as u64 + 1)]);
    }
}

/// A reader that asks for one view, or for some rows of the image, sees in the footers which files, row groups and pages it can skip.
#[test]
fn statistics_say_which_view_is_where() {
    use parquet::file::metadata::{PageIndexPolicy, ParquetMetaDataReader};
    use parquet::file::page_index::column_index::ColumnIndexMetaData;
    let rows = view(0, 200_000, 3);
    let folder = temporary();
    let manifest = write_one(folder.path(), Format::Parquet, &rows, rows.len());
    let file = fs::File::open(folder.path().join(&manifest.parts[0].files[0].name)).unwrap();
    let metadata = ParquetMetaDataReader::new()
        .with_page_index_policy(PageIndexPolicy::Required)
        .parse_and_finish(&file)
        .unwrap();
    let mut first_row = 0;
    for (k, group) in metadata.row_groups().iter().enumerate() {
        let statistics = group.column(Column::View as usize).statistics().unwrap();
        let ends = [statistics.min_bytes_opt(), statistics.max_bytes_opt()];
        assert_eq!(ends, [Some(&[0; 4][..]); 2]);
        // Pages of image rows: what each may hold is known, and where it lies.
        let pages = metadata.page_index_for_row_group(k);
        let y = Column::Y as usize;
        let Some(ColumnIndexMetaData::INT32(index)) = pages.column_index(y) else {
            panic!("no index of pages")
        };
        let places = pages.offset_index(y).unwrap().page_locations();
        assert!(k > 0 || places.len() > 4, "{} pages", places.len());
        let firsts = places
            .iter()
            .map(move |p| first_row + p.first_row_index as usize);
        first_row += group.num_rows() as usize;
        let ends = firsts.clone().skip(1).chain([first_row]);
        for (page, (start, end)) in firsts.zip(ends).enumerate() {
            let found = [index.min_value(page), index.max_value(page)].map(|y| *y.unwrap() as u32);
            assert_eq!(found, [rows.y[start], rows.y[end - 1]]);
        }
    }
    assert_eq!(first_row, rows.len());
}
