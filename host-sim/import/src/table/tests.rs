use super::*;
use mindgap_files as files;

type Rows = Vec<Vec<Option<f64>>>;

fn read(text: &str) -> Result<(Vec<String>, Rows, Vec<LeftOut>)> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("t.csv");
    files::write(&file, text)?;
    let table = Table::find(&file, read_source(&file)?)?;
    let mut rows = Vec::new();
    let left_out = table.for_each(|line| {
        rows.push((0..table.names().len()).map(|column| line.number(column)).collect::<Result<_>>()?);
        Ok(())
    })?;
    Ok((table.names().to_vec(), rows, left_out))
}

fn expected() -> (Vec<String>, Rows) {
    (vec!["t".to_owned(), "x m".to_owned()], vec![vec![Some(0.0), Some(1.5)], vec![Some(1.0), None]])
}

#[test]
fn separators_and_header_styles_are_recognised() {
    for text in [
        "t,x m\n0,1.5\n1,\n",
        "\u{feff}t;x m\r\n0;1,5\r\n1;\r\n",
        "sep=;\nt;x m\n0;1,5\n1;#N/A\n",
        "\"sep=,\"\nt,x m\n0,\"1,5\"\n1,n/a\n",
        "# made by hand\n\nt\tx m\n0\t1.5\n1\tNaN\n",
        "\"t\" | \"x m\"\n0 | 1.5\n1 | nan\n",
        "# made by hand\n# t,x m\n0,1.5\n1,null\n",
        "t,x m\n# in between\n0,1.5\n1,#N/A\n",
        "t,x m\ns,m\n0,1.5\n1,-\n",
        "t,x m,\n0,1.5,\n1,,\n",
    ] {
        let (names, rows, left_out) = read(text).expect(text);
        let two = rows.into_iter().map(|row| row[..2].to_vec()).collect();
        assert_eq!((names[..2].to_vec(), two), expected(), "{text:?}");
        assert_eq!(left_out, [], "{text:?}");
    }
    let spaces = read("% t   x\n  0   1.5\n1 -\n").expect("blanks");
    assert_eq!((spaces.0, spaces.1), (vec!["t".to_owned(), "x".to_owned()], expected().1));
    let quoted = read("\"Motor, left\",\"t [s]\"\n1,2\n").expect("quoted");
    assert_eq!((quoted.0, quoted.1), (vec!["Motor, left".into(), "t [s]".into()], vec![vec![Some(1.0), Some(2.0)]]));
}

#[test]
fn lines_that_are_not_rows_are_left_out_with_the_reason() {
    for (text, what) in [
        ("rst:0x1 (POWERON),boot:0x13\nets Jun  8 2016 00:22:57\nready\nt,x m\n0,1.5\n1,\n", "3 rows (skipped lines)"),
        ("t,x m\n0,1.5\n1,\n2", "line 4, the last line, is incomplete"),
        ("t,x m\n0,1.5\n1,\n2,1.5e", "line 4, the last line, is incomplete"),
        ("t,x m\n0,1.5\nt,x m\n1,\n", "line 3 has the header again"),
        ("t,x m\n0,1.5\n2\nready\nt,x m\n1,\n", "after 2 lines of a restart"),
        ("t,x m\n0,1.5\n2,1.5e\nt,x m\n1,\n", "after 1 lines of a restart"),
        ("t,x m\n0,1.5\n2,1.t,x m\n1,\n", "line 3 has the header again, after 1 lines"),
        ("t,x m\n0,1.5\n1,\n2\0\0\0\0", "line 4, the last line, is incomplete"),
    ] {
        let (names, rows, left_out) = read(text).expect(text);
        assert_eq!((names, rows), expected(), "{text:?}");
        assert!(left_out.len() == 1 && left_out[0].line().contains(what), "{text:?} gave {left_out:?}");
    }
}

#[test]
fn invalid_tables_are_rejected_with_line_number() {
    let long = format!("t,x\n0,1\n1,{}\n2,3\n", "a".repeat(5_000_000));
    for (text, what) in [
        ("", "is empty"),
        ("# only words\n", "contains only comments"),
        ("0,1.5\n1,2\n", ":1: has numbers but no header"),
        ("t,x\n0,1\n1\n2,3\n", ":3: has 1 cells where the header has 2"),
        ("t,x\n0,1\n1,far\n", ":3: x = \"far\" is not a number"),
        ("#c\nt,x\n0,1\n1,far\n", ":4: x = \"far\" is not a number"),
        ("t,x\n0,1\n\"1,2\n2,3\n4,5\n", "a quotation mark before this line is not closed"),
        (
            "t,x\n0,05,1,5\n0,1,1,5\n",
            ":2: has 4 cells where the header has 2: are the decimals separated by commas too?",
        ),
        ("header:\n  stamp:\n    sec: 0\n---\n", "`ros2 topic echo --csv`"),
        ("linear:\n  x: 0.1\n  y: 0.0\n---\n", "is YAML"),
        ("{\"t\": 0}\n", "is JSON"),
        ("PK\u{3}\u{4}...", "save the table as CSV"),
        (&long, "a line of more than 1 MB"),
    ] {
        let error = read(text).expect_err("rejected").to_string();
        assert!(error.contains(what) && !error.contains('\n') && error.len() < 400, "{what:?}: {error:.400}");
    }
}

#[test]
fn gzipped_tables_are_read_up_to_a_limit() {
    use flate2::{Compression, write::GzEncoder};
    use std::io::Write;
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("t.csv.gz");
    let write = |pieces: &mut dyn Iterator<Item = &[u8]>| {
        let mut packed = GzEncoder::new(Vec::new(), Compression::best());
        pieces.for_each(|piece| packed.write_all(piece).expect("memory"));
        files::write(&file, packed.finish().expect("memory")).expect("written");
    };
    write(&mut [b"t,x\n0,1\n".as_slice()].into_iter());
    assert_eq!(read_source(&file).expect("unpacked"), "t,x\n0,1\n");
    let piece = vec![b'0'; 1 << 20];
    write(&mut std::iter::repeat_n(piece.as_slice(), 64));
    let error = read_source(&file).expect_err("a bomb").to_string();
    assert!(error.contains("unpacks to more than 256 times its size") && error.contains("gunzip"), "{error}");
}
