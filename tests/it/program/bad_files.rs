//! Files that cannot be read or written: refused with their place, and nothing is touched.

use super::Bench;
use super::fields::{cells, hilly, lattice, surface};

const LAST: [&str; 3] = ["--extrema", "2", "--quiet"];

fn refuses(bench: &Bench, input: &str, output: &str, words: &[&str]) {
    bench.refuses(&[&["smooth", input, output][..], &LAST].concat(), words);
}

#[test]
fn a_truncated_file() {
    let bench = Bench::with(&hilly(24, 18));
    let whole = std::fs::read(bench.path("in.vti")).unwrap();
    // Without the last two closing tags nothing is missing, and the file is read; with a byte of data less it is not.
    let tail = "\n  </AppendedData>\n</VTKFile>\n".len();
    for part in [1, 40, 300, whole.len() / 2, whole.len() - tail - 1] {
        bench.text("cut.vti", &whole[..part]);
        refuses(&bench, "cut.vti", "out.vti", &["error: cut.vti", "expected"]);
        for command in ["info", "extrema", "check"] {
            bench.refuses(&[command, "cut.vti", "-q"], &["error: cut.vti", "expected"]);
        }
    }
}

#[test]
fn spoiled_bytes_give_an_error_or_an_audited_field() {
    let bench = Bench::with(&hilly(12, 9));
    let whole = std::fs::read(bench.path("in.vti")).unwrap();
    for step in 0..40 {
        let mut spoiled = whole.clone();
        let place = (step * 7919) % whole.len();
        spoiled[place] = spoiled[place].wrapping_add(1 + (step % 200) as u8);
        bench.text("spoiled.vti", &spoiled);
        let run = bench.run(&["smooth", "spoiled.vti", "out.vti", "--extrema", "2", "--array", "h", "-q"]);
        assert!(run.code == 0 || (run.code == 2 && run.stderr.starts_with("error: ")), "byte {place}: {} {}", run.code, run.stderr);
    }
}

#[test]
fn files_that_are_none_of_vtk() {
    let bench = Bench::new();
    bench.text("empty.vti", "");
    bench.text("table.vti", "x,y,h\n1,2,3\n");
    bench.text("picture.vti", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR");
    bench.text("page.vti", "<html></html>");
    refuses(&bench, "empty.vti", "out.vti", &["error: empty.vti: found an empty file; expected a serial VTK XML file, a legacy .vtk file, a mesh (.obj .off .ply .stl .mesh .msh), a table (.csv .tsv), an image (.png), or an array (.npy)"]);
    refuses(&bench, "table.vti", "out.vti", &["error: table.vti", "unknown format", "expected a serial VTK XML file"]);
    refuses(&bench, "picture.vti", "out.vti", &["error: picture.vti", "cannot be read here", "expected a serial VTK XML file"]);
    refuses(&bench, "page.vti", "out.vti", &["error: page.vti, line 1", "<html>", "expected <VTKFile>"]);
}

#[test]
fn a_missing_file_and_a_directory() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("folder")).unwrap();
    refuses(&bench, "no.vti", "out.vti", &["error: cannot read no.vti: No such file"]);
    refuses(&bench, "folder", "out.vti", &["error: cannot read folder", "directory"]);
}

#[test]
fn a_file_without_cells_and_one_without_points() {
    let bench = Bench::with(&surface(&lattice(3, 2), cells(3, &[]), &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    refuses(&bench, "in.vtp", "out.vtp", &["error: in.vtp: the domain is empty: 6 points, 0 cells"]);
    let bench = Bench::with(&surface(&[], cells(3, &[]), &[]));
    refuses(&bench, "in.vtp", "out.vtp", &["error: in.vtp: the domain is empty: 0 points, 0 cells"]);
}

#[test]
fn targets_that_cannot_be_written() {
    let bench = Bench::with(&hilly(24, 18));
    std::fs::create_dir(bench.path("folder.vti")).unwrap();
    refuses(&bench, "in.vti", "no/such/out.vti", &["error: no/such/out.vti: the directory no/such does not exist; expected"]);
    refuses(&bench, "in.vti", "folder.vti", &["error: folder.vti: the output is a directory; expected a file name"]);
    refuses(&bench, "in.vti", "in.vti/out.vti", &["error: in.vti/out.vti", "does not exist; expected"]);
    refuses(&bench, "in.vti", "out.xyz", &["error: cannot write out.xyz: found a name ending in \"xyz\" for ImageData; expected .vti or .vtk"]);
    refuses(&bench, "in.vti", "out", &["error: cannot write out: found a name ending in \"\" for ImageData; expected .vti"]);
    refuses(&bench, "in.vti", "out.vtp", &["error: cannot write out.vtp: found a name ending in \"vtp\" for ImageData"]);
    refuses(&bench, "in.vti", "out.png", &["error: cannot write out.png"]);
}

#[test]
fn outputs_that_are_an_input() {
    let bench = Bench::with(&hilly(24, 18));
    std::fs::create_dir(bench.path("folder")).unwrap();
    let same = ["the output is the input file; expected another name", "hint: the input is never changed"];
    refuses(&bench, "in.vti", "in.vti", &same);
    refuses(&bench, "in.vti", "./folder/../in.vti", &same);
    refuses(&bench, "in.vti", bench.path("in.vti").to_str().unwrap(), &same);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("in.vti", bench.path("link.vti")).unwrap();
        std::fs::hard_link(bench.path("in.vti"), bench.path("hard.vti")).unwrap();
        refuses(&bench, "in.vti", "link.vti", &same);
        refuses(&bench, "link.vti", "in.vti", &same);
        refuses(&bench, "in.vti", "hard.vti", &same);
    }
    bench.text("keep.vtk", "0");
    bench.refuses(&["smooth", "in.vti", "keep.vtk", "--keep", "keep.vtk", "-q"], &["would overwrite the file of --keep"]);
}

#[test]
fn reports_and_pictures_that_cannot_be_written() {
    let bench = Bench::with(&hilly(24, 18));
    std::fs::create_dir(bench.path("folder")).unwrap();
    let with = |more: &[&str], words: &[&str]| {
        bench.refuses(&[&["smooth", "in.vti", "out.vti"][..], &LAST, more].concat(), words);
    };
    with(&["--report", "no/r.json"], &["error: no/r.json: the directory no does not exist"]);
    with(&["--report", "folder"], &["error: folder: the output is a directory"]);
    with(&["--report", "in.vti"], &["error: in.vti: the report would overwrite in.vti; expected another name"]);
    with(&["--report", "./out.vti"], &["the report would overwrite out.vti; expected another name"]);
    with(&["--plots", "in.vti"], &["error: in.vti: in.vti is a file; expected a directory"]);
    with(&["--plots", "in.vti/pictures"], &["in.vti is a file; expected a directory"]);
    for command in ["info", "extrema", "check"] {
        bench.refuses(&[command, "in.vti", "-q", "--report", "in.vti"], &["the report would overwrite in.vti"]);
        bench.refuses(&[command, "in.vti", "-q", "--report", "no/r.json"], &["the directory no does not exist"]);
    }
    bench.refuses(&["extrema", "in.vti", "-q", "--plots", "in.vti"], &["in.vti is a file; expected a directory"]);
}

#[test]
fn an_existing_output_survives_a_refusal() {
    let bench = Bench::with(&hilly(24, 18));
    bench.text("out.vti", "precious");
    refuses(&bench, "no.vti", "out.vti", &["cannot read no.vti"]);
    bench.refuses(&["smooth", "in.vti", "out.vti", "-q", "--extrema", "1"], &["1 extrema asked for"]);
    bench.smooths("in.vti", &["--extrema", "2"]);
}
