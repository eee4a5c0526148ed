//! What is written comes back, with the same bytes however it was written.
#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

mod common;

use std::collections::BTreeSet;

use common::*;
use peelnet_dataset::*;

#[test]
fn rows_come_back_bit_for_bit() {
    for format in Format::ALL {
        let folder = tempfile::tempdir().unwrap();
        let manifest = write(folder.path(), format, None, 2, 333).unwrap();
        let dataset = Dataset::open(folder.path()).unwrap();
        assert_eq!(dataset.manifest(), &manifest);
        dataset.verify().unwrap();
        let expected = all_rows();
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
                if rows_per_batch == 1000 {
                    assert!(batch.len() <= 1000 + 12);
                }
                found.extend_from(&batch, 0..batch.len());
            }
            assert_eq!(bits(&found), bits(&expected), "{format} {rows_per_batch}");
        }
        let wanted = [
            Column::Far,
            Column::View,
            Column::Transmittance,
            Column::View,
        ];
        let columns = dataset.read_columns(&wanted).unwrap();
        for column in wanted {
            assert_eq!(columns.column(column), expected.column(column), "{format}");
        }
        assert!(columns.is_empty(), "nothing else is read");
        let mut views = BTreeSet::new();
        let is_trained = |p: &Part| !dataset.is_held_out(p);
        let read = dataset.read_pieces(&[Column::View], is_trained, |piece| {
            views.extend(piece.view.iter().copied());
        });
        read.unwrap();
        assert_eq!(views, [0, 1].into());
        assert!(dataset.read_columns(&[]).unwrap().is_empty());
    }
}

#[test]
fn threads_and_batches_do_not_change_the_bytes() {
    for format in Format::ALL {
        let reference = tempfile::tempdir().unwrap();
        write(reference.path(), format, None, 1, usize::MAX / 2).unwrap();
        let reference = contents(reference.path());
        for (threads, batch) in [(1, 1), (2, 100), (3, 5000), (16, usize::MAX / 2)] {
            let folder = tempfile::tempdir().unwrap();
            write(folder.path(), format, None, threads, batch).unwrap();
            assert!(
                contents(folder.path()) == reference,
                "{format}, {threads} threads, batches of {batch}"
            );
        }
    }
}

/// More rows than a row group and than a buffer of text, so that the threads have work.
#[test]
fn large_parts_are_the_same_with_any_threads() {
    let rows = view(0, 200_000, 3);
    assert!(rows.len() > ROW_GROUP_ROWS);
    for format in Format::ALL {
        let write = |threads, batch_rows| {
            let folder = tempfile::tempdir().unwrap();
            let header = Header {
                work_items: 1,
                ..header(format, None)
            };
            let writer = DatasetWriter::create(folder.path(), header).unwrap();
            let writer = writer.with_threads(threads);
            part(&writer, 0, &rows, batch_rows).unwrap();
            let manifest = writer.finish().unwrap();
            let dataset = Dataset::open(folder.path()).unwrap();
            let depth = dataset.read_columns(&[Column::LinearDepth]).unwrap();
            assert!(depth.linear_depth == rows.linear_depth);
            manifest
        };
        let one = write(1, rows.len());
        if format == Format::Parquet {
            let first = ROW_GROUP_ROWS as u64;
            let groups = [first, rows.len() as u64 - first];
            assert_eq!(one.parts[0].row_groups, groups);
        }
        assert_eq!(one, write(2, 100_001));
        assert_eq!(one, write(4, rows.len()));
    }
}

#[test]
fn csv_is_the_shortest_text() {
    let folder = tempfile::tempdir().unwrap();
    let mut rows = view(0, 1, 1);
    rows.truncate(1);
    rows.one_minus_alpha[0] = 0.1;
    rows.linear_depth[0] = 16_777_216.0;
    rows.alpha_sum[0] = 0.9;
    rows.fragment_count[0] = 1;
    rows.r[0] = 1e-7;
    rows.g[0] = -0.0;
    rows.b[0] = 1.0 / 3.0;
    write_one(folder.path(), Format::Csv, &rows);
    let text = std::fs::read_to_string(folder.path().join("fragments-00000-cups-v0.csv"));
    assert_eq!(
        text.unwrap(),
        "one_minus_alpha,linear_depth,alpha_sum,fragment_count,transmittance,view,x,y,layer,r,g,b,near,far\n\
         0.1,16777216.0,0.9,1,1.0,0,0,0,0,1e-7,-0.0,0.33333334,0.1,100.0\n"
    );
}

#[test]
fn npy_arrays_are_plain_numpy() {
    use ndarray_npy::ReadNpyExt;
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), Format::Npy, None, 2, 1000).unwrap();
    let name = "fragments-00002-smoke-in-a-box-v0";
    let open = |column: &str| {
        std::fs::File::open(folder.path().join(format!("{name}.{column}.npy"))).unwrap()
    };
    let rows = view(2, pixels(2), 1);
    let depth = ndarray::Array1::<f32>::read_npy(open("linear_depth")).unwrap();
    assert_eq!(depth.to_vec(), rows.linear_depth);
    let x = ndarray::Array1::<u32>::read_npy(open("x")).unwrap();
    assert_eq!(x.to_vec(), rows.x);
}

#[test]
fn sums_are_checked() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), Format::Parquet, None, 2, 1000).unwrap();
    let dataset = Dataset::open(folder.path()).unwrap();
    let summary = Summary::of(&dataset).unwrap();
    assert!(summary.passes(), "{:?}", summary.violations);
    assert_eq!(summary.rows, dataset.rows());
    assert_eq!(summary.pixels, dataset.manifest().pixels);
    let total = |bins: &[summary::Bin]| bins.iter().map(|b| b.count).sum::<u64>();
    assert_eq!(total(&summary.alpha), summary.rows);
    assert_eq!(total(&summary.fragments_per_pixel), summary.pixels);
    assert_eq!(summary.fragments_per_pixel.last().unwrap().to, 16.0);
    assert_eq!(summary.scenes[1].rows, view(2, 1500, 1).len() as u64);

    // Each kind of contradiction is found, in the row where it is.
    type Spoil = fn(&mut FragmentBatch, usize);
    let spoils: [(&str, Spoil); 5] = [
        ("transmittance", |rows, i| {
            rows.transmittance[i] = (rows.transmittance[i] - 0.001).max(0.0);
        }),
        ("alpha_sum", |rows, i| rows.alpha_sum[i] += 0.001),
        ("fragment_count", |rows, i| rows.fragment_count[i] += 1),
        ("layer", |rows, i| rows.layer[i] += 1),
        ("linear_depth", |rows, i| rows.linear_depth[i] = 1e-3),
    ];
    for (name, spoil) in spoils {
        let folder = tempfile::tempdir().unwrap();
        let mut rows = view(0, 50, 1);
        let i = (0..rows.len())
            .find(|&i| rows.layer[i] == 1 && rows.transmittance[i] > 0.1)
            .unwrap();
        spoil(&mut rows, i);
        write_one(folder.path(), Format::Npy, &rows);
        let summary = Summary::of(&Dataset::open(folder.path()).unwrap()).unwrap();
        let found: Vec<_> = summary
            .violations
            .iter()
            .map(|v| (v.check.as_str(), v.row))
            .collect();
        assert_eq!(found, [(name, i as u64 + 1)]);
    }
}

/// A reader that asks for one view, or for some rows of the image, sees in the footers which files, row groups and pages it can skip.
#[test]
fn statistics_say_which_view_is_where() {
    use parquet::file::metadata::{PageIndexPolicy, ParquetMetaDataReader};
    use parquet::file::page_index::column_index::ColumnIndexMetaData;
    let rows = view(1, 200_000, 3);
    let folder = tempfile::tempdir().unwrap();
    let mut header = header(Format::Parquet, None);
    header.work_items = 2;
    let writer = DatasetWriter::create(folder.path(), header).unwrap();
    part(&writer, 0, &view(0, 50, 3), 100).unwrap();
    part(&writer, 1, &rows, rows.len()).unwrap();
    let manifest = writer.finish().unwrap();
    for part in &manifest.parts {
        let file = std::fs::File::open(folder.path().join(&part.files[0].name)).unwrap();
        let metadata = ParquetMetaDataReader::new()
            .with_page_index_policy(PageIndexPolicy::Required)
            .parse_and_finish(&file)
            .unwrap();
        let mut first_row = 0;
        for (k, group) in metadata.row_groups().iter().enumerate() {
            let statistics = group.column(Column::View.index()).statistics().unwrap();
            let view = part.index.to_le_bytes();
            assert_eq!(statistics.min_bytes_opt(), Some(&view[..]));
            assert_eq!(statistics.max_bytes_opt(), Some(&view[..]));
            // Pages of image rows: what each may hold is known, and where it lies.
            let pages = metadata.page_index_for_row_group(k);
            let y = Column::Y.index();
            let Some(ColumnIndexMetaData::INT32(index)) = pages.column_index(y) else {
                panic!("no index of pages")
            };
            let places = pages.offset_index(y).unwrap().page_locations();
            assert_eq!(index.num_pages() as usize, places.len());
            let firsts = places.iter().map(|p| p.first_row_index as usize);
            let ends = firsts.clone().skip(1).chain([group.num_rows() as usize]);
            for (page, (start, end)) in firsts.zip(ends).enumerate() {
                let least = *index.min_value(page).unwrap();
                let most = *index.max_value(page).unwrap();
                if part.index == 1 {
                    let inside = &rows.y[first_row + start..first_row + end];
                    assert_eq!(least as u32, inside[0]);
                    assert_eq!(most as u32, *inside.last().unwrap());
                }
            }
            if part.index == 1 && k == 0 {
                assert!(places.len() > 4, "{} pages", places.len());
            }
            first_row += group.num_rows() as usize;
        }
    }
}
