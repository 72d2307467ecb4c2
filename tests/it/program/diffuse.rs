//! `morsmooth diffuse`: colours on outlines and images, the gamut, refusals.

use morsmooth::io::{ArrayData, image_dataset};

use super::Bench;

/// A letter J: a stem with a hook and a bar across its head.
const LETTER: &str = "x,y\n0,2\n0.5,0.8\n1.6,0\n3,0\n4.2,0.8\n4.6,2\n4.6,7\n5.6,7\n5.6,8\n2.4,8\n2.4,7\n3.6,7\n3.6,2\n3.2,1.2\n2.6,1\n1.8,1\n1.2,1.3\n1,2\n";
const COLOURS: &str = "x,y,colour\n4.1,4.5,#d02020\n4.1,6,#909090\n4.1,3,#2040c0\n1.9,0.5,#f0e040\n";

#[test]
fn monotone_colours_stay_among_the_given_ones_where_others_do_not() {
    let bench = Bench::new();
    bench.text("j.csv", LETTER);
    bench.text("colours.csv", COLOURS);
    let run = |method: &str| {
        let run = bench.run(&[
            "diffuse", "j.csv", "j.png", "j.vtu", "--colours", "colours.csv", "--method", method, "--width", "120", "--max-edge", "3%",
            "--report", "r.json",
        ]);
        assert_eq!(run.code, 0, "{method}: {}{}", run.stdout, run.stderr);
        let report = bench.json("r.json");
        let spurious: u64 = (0..3).map(|channel| report["channels"][channel]["spurious"].as_u64().unwrap()).sum();
        (spurious, report["vertices_outside_given_range"].as_u64().unwrap(), report["pixels"]["out_of_gamut"].as_u64().unwrap())
    };
    let (spurious, outside, beyond) = run("polyharmonic");
    assert!(spurious > 0 && outside > 0 && beyond > 0, "{spurious} {outside} {beyond}");
    let (spurious, outside, beyond) = run("bounded");
    assert!(spurious > 0, "{spurious}");
    assert_eq!((outside, beyond), (0, 0));
    assert_eq!(run("monotone"), (0, 0, 0));
    let mesh = bench.read("j.vtu");
    let red = mesh.point_array("red").unwrap().to_f64(0);
    let ArrayData::U8(bytes) = &mesh.point_array("RGB").unwrap().data else { panic!() };
    assert!(red.iter().zip(bytes.chunks(3)).all(|(red, bytes)| (red * 255.0).round() == f64::from(bytes[0])));
    let image = bench.read("j.png");
    let ArrayData::U8(pixels) = &image.point_data.arrays[0].data else { panic!() };
    let covered = pixels.chunks(4).filter(|pixel| pixel[3] == 255).count();
    assert!(covered > 2000 && pixels.chunks(4).any(|pixel| pixel == [0; 4]), "{covered}");
    // Every pixel between the least and the greatest given red.
    assert!(pixels.chunks(4).filter(|pixel| pixel[3] == 255).all(|pixel| (0x20..=0xf0).contains(&pixel[0])));
}

#[test]
fn an_image_is_a_domain_and_a_list_of_colours() {
    let bench = Bench::new();
    let (width, height) = (24u32, 16u32);
    // Transparent on the right, white in a corner.
    let shape: Vec<u8> = (0..width * height)
        .flat_map(|pixel| if pixel % width > 20 { [9, 9, 9, 0] } else if pixel / width < 3 && pixel % width < 3 { [255; 4] } else { [9, 9, 9, 255] })
        .collect();
    let mut dabs = vec![0u8; (4 * width * height) as usize];
    for (column, row, colour) in [(4, 9, [255, 0, 0, 255]), (18, 4, [0, 255, 64, 255]), (12, 13, [30, 30, 250, 255])] {
        dabs[4 * (row * width as usize + column)..][..4].copy_from_slice(&colour);
    }
    bench.put("shape.png", &image_dataset(width, height, &shape));
    bench.put("dabs.png", &image_dataset(width, height, &dabs));
    let run = bench.run(&["diffuse", "shape.png", "out.png", "out.vti", "--colours", "dabs.png", "--outside", "#ffffff"]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    let out = bench.read("out.png");
    assert_eq!(out.geometry, bench.read("shape.png").geometry);
    let ArrayData::U8(pixels) = &out.point_data.arrays[0].data else { panic!() };
    // Rows of a data set run upwards.
    let pixel = |column: usize, row: usize| &pixels[4 * ((height as usize - 1 - row) * width as usize + column)..][..4];
    assert_eq!((pixel(4, 9), pixel(18, 4), pixel(12, 13)), (&[255, 0, 0, 255][..], &[0, 255, 64, 255][..], &[30, 30, 250, 255][..]));
    assert_eq!((pixel(22, 5), pixel(1, 1)), (&[0; 4][..], &[0; 4][..]));
    assert_eq!(pixel(10, 8)[3], 255);
}

#[test]
fn colours_run_along_curves() {
    let bench = Bench::new();
    bench.text("square.csv", "x,y\n0,0\n4,0\n4,4\n0,4\n");
    bench.text("curves.json", r##"[{"curve": [[0, 0], [4, 0]], "colours": ["#000000", "#ff0000"]}, {"curve": [[0, 4], [4, 4]], "colour": "#0000ff"}]"##);
    let run = bench.run(&["diffuse", "square.csv", "out.png", "out.vtp", "--colours", "curves.json", "--max-edge", "5%", "--blend", "channels"]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    let mesh = bench.read("out.vtp");
    let (red, blue) = (mesh.point_array("red").unwrap().to_f64(0), mesh.point_array("blue").unwrap().to_f64(0));
    for (point, [x, y, _]) in mesh.points_f64().into_iter().enumerate() {
        if y == 0.0 {
            assert!((red[point] - x / 4.0).abs() < 1e-12 && blue[point] == 0.0, "{x}");
        } else if y == 4.0 {
            assert_eq!((red[point], blue[point]), (0.0, 1.0), "{x}");
        }
    }
}

#[test]
fn refusals_name_file_place_and_remedy() {
    let bench = Bench::new();
    bench.text("j.csv", LETTER);
    bench.text("c.csv", COLOURS);
    bench.text("bad.csv", "x,y,colour\n4,4,red\n");
    bench.text("twice.csv", "x,y,colour\n4.1,4.5,#ff0000\n4.1,4.5,#00ff00\n");
    bench.text("far.csv", "x,y,colour\n40,4,#ff0000\n");
    bench.text("bytes.csv", "x,y,r,g,b\n4,4,1,2,300\n");
    bench.text("no.csv", "x,y\n4,4\n");
    let refuses = |colours: &str, words: &[&str]| bench.refuses(&["diffuse", "j.csv", "out.png", "--colours", colours], words);
    refuses("bad.csv", &["bad.csv: line 2: found 'red'; expected a colour such as #ff8000"]);
    refuses("twice.csv", &["twice.csv: line 2 and line 3 give point ", "the colours #ff0000 and #00ff00; expected one colour a vertex"]);
    refuses("far.csv", &["far.csv: line 2: the position [40.0, 4.0, 0.0] is ", "farther than its longest edge; expected a position on the mesh"]);
    refuses("bytes.csv", &["bytes.csv: line 2: found '300'; expected a number from 0 to 255"]);
    refuses("no.csv", &["no.csv: found the columns x, y; expected x, y (or point) and colour (or r, g, b)"]);
    // A running number is no point number.
    bench.text("numbered.csv", "id,x,y,colour\n1,40,4,#ff0000\n");
    refuses("numbered.csv", &["numbered.csv: line 2: the position [40.0, 4.0, 0.0] is "]);
    bench.refuses(&["diffuse", "j.csv", "out.jpg", "--colours", "c.csv"], &["out.jpg: the image has another ending; expected .png"]);
    bench.refuses(&["diffuse", "j.csv", "out.png", "--colours", "c.csv", "--outside", "#fff"], &["found --outside for a shape that is no image"]);
    bench.refuses(&["diffuse", "j.csv", "out.png", "--colours", "c.csv", "--pixel", "1e-9"], &["expected 1 to 16384"]);
}
