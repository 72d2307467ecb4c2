//! `morsmooth series`: tables in and out, dates, missing values, corners, refusals.

use std::fmt::Write;

use morsmooth::io::Table;

use super::Bench;

/// A wave with noise on irregular days, rows from the last day to the first, decimal commas, a column of words.
fn rates() -> String {
    let mut rows: Vec<String> = Vec::new();
    let mut seed = 7u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 40) as f64 / (1u64 << 24) as f64 - 0.5
    };
    for day in (1..=28).filter(|day| day % 7 != 0) {
        for month in 1..=12 {
            let x = f64::from(month) + f64::from(day) / 31.0;
            let value = 3.0 + (x * 1.3).sin() + 0.2 * random();
            rows.push(format!("2001-{month:02}-{day:02};{};w{day}", format!("{value:.4}").replace('.', ",")));
        }
    }
    rows.sort();
    rows.reverse();
    format!("# rates\nday;eur;\"a; word\"\n{}\n", rows.join("\n"))
}

/// Values by rising place, and the places.
fn column(bench: &Bench, file: &str, x: &str, name: &str) -> (Vec<f64>, Vec<f64>) {
    let table = Table::read(bench.path(file)).unwrap();
    let places = table.axis(table.column(x).unwrap()).unwrap().values;
    let values = table.numbers(table.column(name).unwrap()).unwrap();
    let mut pairs: Vec<(f64, f64)> = places.into_iter().zip(values).filter(|pair| !pair.1.is_nan()).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    pairs.into_iter().unzip()
}

/// Minima and maxima under plain `<`, ends included.
fn extrema(values: &[f64]) -> [usize; 2] {
    let at = |place: usize, sign: f64| {
        let above = |other: Option<&f64>| other.is_none_or(|other| sign * other > sign * values[place]);
        above(place.checked_sub(1).and_then(|before| values.get(before))) && above(values.get(place + 1))
    };
    [1.0, -1.0].map(|sign| (0..values.len()).filter(|&place| at(place, sign)).count())
}

#[test]
fn a_table_keeps_every_cell_and_gains_a_column_with_exactly_the_wanted_extrema() {
    let bench = Bench::new();
    bench.text("rates.csv", rates());
    for order in ["1", "2", "3", "4"] {
        let run = bench.run(&["series", "rates.csv", "out.csv", "--y", "eur", "--persistence", "20%", "--order", order, "--report", "r.json"]);
        assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
        let written = std::fs::read_to_string(bench.path("out.csv")).unwrap();
        for (before, after) in rates().lines().zip(written.lines()).skip(1) {
            assert!(after.starts_with(before) && after.len() > before.len(), "{after}");
        }
        assert!(written.starts_with("# rates\nday;eur;\"a; word\";eur_smooth\n2001-12-27;"), "{written}");
        let report = bench.json("r.json");
        assert_eq!((&report["series"]["x"], &report["series"]["dates"]), (&"day".into(), &true.into()));
        let (_, data) = column(&bench, "out.csv", "day", "eur");
        let (_, smooth) = column(&bench, "out.csv", "day", "eur_smooth");
        let wanted = ["minima", "maxima"].map(|kind| report["series"][kind].as_array().unwrap().len());
        assert_eq!(extrema(&smooth), wanted);
        assert!(wanted[0] < 6 && extrema(&data)[0] > 3 * wanted[0], "{wanted:?}");
    }
}

#[test]
fn a_corner_is_kept_where_it_is_asked_for_and_smoothed_elsewhere() {
    let bench = Bench::new();
    let mut text = "x,y\n".to_owned();
    for row in 0..201 {
        let x = f64::from(row) + 0.3 * f64::from(row % 3);
        let y = 100.0 - (x - 100.3).abs() + 0.4 * f64::from(row * 7919 % 13 - 6);
        writeln!(text, "{x},{y}").unwrap();
    }
    bench.text("peak.csv", text);
    let sharpness = |more: &[&str], order: &str| {
        let fixed = ["series", "peak.csv", "out.csv", "--persistence", "50%", "--length-abs", "12", "--order", order, "--report", "r.json"];
        let run = bench.run(&[&fixed, more].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        let (places, values) = column(&bench, "out.csv", "x", "y_smooth");
        let peak = (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap();
        assert!(extrema(&values)[1] == 1 && (peak as i64 - 100).abs() < 12, "{peak}");
        let slope = |a: usize, b: usize| (values[b] - values[a]) / (places[b] - places[a]);
        slope(peak - 1, peak) - slope(peak, peak + 1)
    };
    for order in ["2", "3", "4"] {
        let (round, sharp) = (sharpness(&[], order), sharpness(&["--spike", "max"], order));
        assert!(sharp > 2.0 * round && sharp > 1.0, "order {order}: {sharp} against {round}");
        let spikes = bench.json("r.json")["series"]["spikes"].clone();
        assert_eq!((spikes.as_array().unwrap().len(), &spikes[0]["kind"]), (1, &"maximum".into()));
        assert!(sharpness(&["--spikes", "all"], order) > 2.0 * round);
    }
}

#[test]
fn missing_values_are_bridged_or_filled() {
    let bench = Bench::new();
    bench.text("a.csv", "t,v,ok\n0,.,1\n1,1,1\n2,,1\n4,NaN,1\n7,4,1\n8,5,1\n9,9,0\n10,3,1\n11,2,1\n12,1,1\n");
    let cells = |name: &str| {
        let table = Table::read(bench.path("out.csv")).unwrap();
        let column = table.column(name).unwrap();
        (0..table.len()).map(|row| table.cell(row, column).to_owned()).collect::<Vec<_>>()
    };
    let fixed = ["series", "a.csv", "out.csv", "--y", "v", "--persistence", "30%", "--length-abs", "1"];
    assert_eq!(bench.run(&fixed).code, 0);
    let gaps = |cells: &[String]| (0..cells.len()).filter(|&row| cells[row].is_empty()).collect::<Vec<_>>();
    assert_eq!(gaps(&cells("v_smooth")), [0, 2, 3]);
    assert_eq!(cells("v")[..4], [".", "1", "", "NaN"]);
    let run = bench.run(&[&fixed[..], &["--missing", "fill"]].concat());
    assert!(run.stderr.contains("note: column v: 3 of 10 values are missing; 2 of them filled"), "{}", run.stderr);
    assert_eq!(gaps(&cells("v_smooth")), [0], "nothing lies before the first value");
    let filled: Vec<f64> = cells("v_smooth")[1..5].iter().map(|cell| cell.parse().unwrap()).collect();
    assert!(filled.is_sorted_by(|a, b| a < b), "{filled:?}");
    assert_eq!(bench.run(&[&fixed[..], &["--mask", "ok"]].concat()).code, 0);
    assert_eq!(gaps(&cells("v_smooth")), [0, 2, 3, 6]);
    assert_eq!(cells("v_smooth")[5], "5.0", "without the masked peak, this is the maximum");
}

#[test]
fn several_columns_and_thresholds_give_a_column_each_and_a_plot_each() {
    let bench = Bench::new();
    let rows: String = (0..60).map(|row| format!("{row},{},{}\n", (row * 37) % 11, (row * 17) % 7)).collect();
    bench.text("a.csv", format!("t,u,v\n{rows}"));
    let run = bench.run(&["series", "a.csv", "out.tsv", "--y", "u,v", "--persistence", "50%,95%", "--plot", "p.svg", "--length-abs", "2"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let table = Table::read(bench.path("out.tsv")).unwrap();
    assert_eq!(table.names()[3..], ["u_smooth_50pct", "u_smooth_95pct", "v_smooth_50pct", "v_smooth_95pct"]);
    for name in &table.names()[3..] {
        let svg = std::fs::read_to_string(bench.path(&format!("p_{name}.svg"))).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("maxima") && svg.ends_with("</svg>\n"));
    }
    let run = bench.run(&["series", "a.csv", "out.vtp", "--y", "u", "--persistence", "50%", "--plot", "p.png", "-q"]);
    assert_eq!((run.code, run.stdout.as_str()), (0, ""));
    let line = bench.read("out.vtp");
    assert_eq!((line.point_count(), line.cell_count()), (60, 59));
    assert!(line.point_array("u_smooth").is_some() && line.point_array("v").is_some());
    assert!(std::fs::read(bench.path("p.png")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn tables_go_through_the_other_commands() {
    let bench = Bench::new();
    bench.text("in.csv", "# head\nday,word,v\n2001-01-05,a,1\n2001-01-03,b,3\n2001-01-04,\"c,d\",\n2001-01-09,e,2\n2001-01-10,f,0.5\n");
    assert_eq!(bench.run(&["convert", "in.csv", "line.vtp", "-q"]).code, 0);
    assert_eq!(bench.run(&["convert", "line.vtp", "again.csv", "-q"]).code, 0);
    let again = std::fs::read_to_string(bench.path("again.csv")).unwrap();
    assert_eq!(again, "day,word,v\n2001-01-05,a,1.0\n2001-01-03,b,3.0\n2001-01-04,\"c,d\",\n2001-01-09,e,2.0\n2001-01-10,f,0.5\n");
    let run = bench.run(&["smooth", "in.csv", "out.csv", "--persistence", "1%", "--length-abs", "1", "-q"]);
    assert_eq!((run.code, run.stderr.as_str()), (0, ""));
    assert_eq!(Table::read(bench.path("out.csv")).unwrap().names(), ["day", "word", "v", "v_smooth"]);
}

#[test]
fn refusals_name_file_place_and_remedy() {
    let bench = Bench::new();
    bench.text("a.csv", "t,u,v\n2001-01-01,1,2\n2001-01-02,3,1\n2001-01-03,2,4\n");
    bench.text("twice.csv", "t,u\n1,1\n2,5\n1,3\n");
    bench.text("words.csv", "t,u\nx,y\n");
    bench.text("bad.csv", "t,u\n1,2\n2,oops\n");
    bench.text("one.csv", "t,u\n1,2\n2,\n");
    let refuses = |arguments: &[&str], word: &str| bench.refuses(&[&["series"], arguments].concat(), &[word]);
    refuses(&["a.csv", "o.csv", "--persistence", "5%"], "a.csv: found 2 columns of numbers; expected --y COLUMN\nhint: columns: u, v");
    refuses(&["a.csv", "o.csv", "--y", "w", "--persistence", "5%"], "a.csv: found no column 'w'; expected one of: t, u, v");
    refuses(&["a.csv", "o.csv", "--x", "w", "--persistence", "5%"], "a.csv: found no column 'w'; expected one of: t, u, v");
    refuses(&["a.csv", "o.csv", "--y", "u"], "found no wanted extrema; expected one of --persistence");
    refuses(&["a.csv", "o.csv", "--y", "t", "--persistence", "5%"], "column 't' is x and cannot be y as well; expected another --y");
    refuses(&["twice.csv", "o.csv", "--x", "t", "--persistence", "5%"], "twice.csv, line 4, column 1: found \"1\" in column \"t\"; expected another place than that of line 2");
    refuses(&["words.csv", "o.csv", "--persistence", "5%"], "words.csv: found no column of dates and none of rising numbers; expected --x COLUMN");
    refuses(&["bad.csv", "o.csv", "--y", "u", "--persistence", "5%"], "bad.csv, line 3, column 2: found \"oops\" in column \"u\"; expected a finite number, or nothing");
    refuses(&["one.csv", "o.csv", "--persistence", "5%"], "one.csv: column 'u' has one value only; expected two at least");
    let spike = ["a.csv", "o.csv", "--y", "u", "--persistence", "5%", "--spike"];
    refuses(&[&spike[..], &["soon"]].concat(), "found --spike 'soon'; expected a date such as 2001-01-05, max or min");
    refuses(&[&spike[..], &["2001-01-09"]].concat(), "a.csv: column u has no value at '2001-01-09' of --spike; the nearest is at 2001-01-03");
    refuses(
        &["a.csv", "o.csv", "--y", "u", "--persistence", "5%", "--spikes", "all", "--select", "smooth"],
        "found --spikes all with --select smooth, where extrema are known only afterwards; expected --spike PLACE, or --select data",
    );
    refuses(&["a.csv", "o.csv", "--y", "u", "--persistence", "5%", "--plot", "p.pdf"], "p.pdf: found a plot ending in 'pdf'; expected .svg or .png");
    refuses(&["a.csv", "a.csv", "--y", "u", "--persistence", "5%"], "a.csv: the output is the input file; expected another name");
    refuses(&["a.csv", "o.csv", "--y", "u", "--persistence", "5%", "--output-array", "v"], "the result would replace the array 'v' of the input");
}
