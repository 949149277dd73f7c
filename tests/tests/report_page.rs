//! The demo's report in a real browser: what a reader does, done; nothing may fail and nothing be fetched.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};

use fieldwalk::system::Recipe;
use fieldwalk_tests::browser::{Browser, Screen};
use serde_json::Value;

const DESKTOP: Screen = Screen { width: 1280, height: 800, is_phone: false, is_dark: false };
const PHONE: Screen = Screen { width: 390, height: 844, is_phone: true, is_dark: true };

/// A digest of what a canvas shows, read from a copy: Chromium complains of a canvas that is read often.
const PIXELS: &str = "((id) => { const shown = document.getElementById(id); \
    const copy = document.createElement('canvas'); copy.width = shown.width; copy.height = shown.height; \
    const context = copy.getContext('2d', { willReadFrequently: true }); context.drawImage(shown, 0, 0); \
    let hash = 7; for (const byte of context.getImageData(0, 0, copy.width, copy.height).data) \
    hash = (Math.imul(hash, 31) + byte) | 0; return hash; })";

fn folder() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("report_page")
}

/// The report of a demo of two walks, made once.
fn report() -> PathBuf {
    let out = folder();
    let file = out.join("report.html");
    let _ = fs::remove_file(&file);
    let arguments = ["fieldwalk", "demo", "--seed", "1", "--walks", "2", "--out", out.to_str().unwrap()];
    let code = fieldwalk_cli::run_from(arguments);
    assert!(file.is_file(), "{code:?}");
    file
}

struct Reader(Browser);

impl Reader {
    fn value(&mut self, expression: &str) -> Value {
        self.0.evaluate(expression).unwrap()
    }

    fn text(&mut self, id: &str) -> String {
        self.value(&format!("document.getElementById('{id}').textContent")).as_str().unwrap().to_owned()
    }

    fn pixels(&mut self, canvas: &str) -> i64 {
        self.0.frame().unwrap();
        self.value(&format!("{PIXELS}('{canvas}')")).as_i64().unwrap()
    }

    fn time_s(&mut self) -> f64 {
        self.value("Number(document.getElementById('time').value)").as_f64().unwrap()
    }

    /// Does `act` and expects that it changes what `canvas` shows.
    #[track_caller]
    fn changes(&mut self, canvas: &str, act: impl FnOnce(&mut Self)) {
        let before = self.pixels(canvas);
        act(self);
        assert_ne!(before, self.pixels(canvas), "the {canvas} shows the same as before");
    }

    fn click(&mut self, selector: &str) {
        self.value(&format!("document.querySelector('{selector}').click()"));
    }

    #[track_caller]
    fn has_no_complaint(&self) {
        let complaints = self.0.complaints();
        assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    }

    /// The middle of what `id` shows.
    fn middle(&mut self, id: &str) -> [f64; 2] {
        let script = format!(
            "(() => {{ const box = document.getElementById('{id}').getBoundingClientRect(); \
             return [box.x + box.width / 2, box.y + box.height / 2]; }})()"
        );
        let at = self.value(&script);
        [at[0].as_f64().unwrap(), at[1].as_f64().unwrap()]
    }
}

#[test]
fn a_report_is_played_switched_and_read() {
    let Some(browser) = Browser::start(&folder().join(format!("profile-{}", std::process::id()))).unwrap()
    else {
        return;
    };
    let file = report();
    assert!(fs::metadata(&file).unwrap().len() < 5_000_000);
    let mut reader = Reader(browser);
    on_a_desk(&mut reader, &file);
    on_a_phone(&mut reader, &file);
    many_systems_on_a_desk(&mut reader, &of_many_systems(&file));
}

/// The page in `file` with as many systems as there are, two kinds of points, and the demo's figures for all of them.
fn of_many_systems(file: &Path) -> PathBuf {
    let html = fs::read_to_string(file).unwrap();
    let (before, rest) = html.split_once("id=\"figures\">").unwrap();
    let (figures, after) = rest.split_once("</script>").unwrap();
    let mut figures: Value = serde_json::from_str(figures).unwrap();
    let n_systems = Recipe::NAMES.len();
    let repeated = |list: &Value| {
        (0..n_systems).map(|k| list[k % list.as_array().unwrap().len()].clone()).collect::<Value>()
    };
    figures["systems"] = serde_json::json!(Recipe::NAMES);
    figures["primary"] = (n_systems - 1).into();
    for walk in figures["walks"].as_array_mut().unwrap() {
        for of_systems in ["tracks", "errors"] {
            walk[of_systems] = repeated(&walk[of_systems]);
        }
    }
    let named = |list: Value, key: &str, points: &str| {
        let mut list = list;
        for (object, name) in list.as_array_mut().unwrap().iter_mut().zip(Recipe::NAMES) {
            object[key] = name.into();
            object["points"] = points.into();
        }
        list
    };
    figures["curves"] = named(repeated(&figures["curves"]), "system", "waypoint");
    // As an evaluation writes them: system by system, kind by kind.
    let of_kind = |points: &str| named(repeated(&figures["rows"]), "system", points);
    let [waypoints, cut_offs] = [of_kind("waypoint"), of_kind("cut_off")];
    let rows = (0..n_systems).flat_map(|k| [cut_offs[k].clone(), waypoints[k].clone()]);
    figures["rows"] = rows.collect();
    let many = file.with_file_name("many-systems.html");
    let figures = figures.to_string().replace('<', "\\u003c");
    fs::write(&many, format!("{before}id=\"figures\">{figures}</script>{after}")).unwrap();
    many
}

fn many_systems_on_a_desk(reader: &mut Reader, file: &Path) {
    reader.0.open(file, DESKTOP).unwrap();
    let n_systems = Recipe::NAMES.len();
    // Waypoints come before cut-offs, and both have a name.
    let kinds = reader.value(
        "[...document.querySelectorAll('#rows tbody tr')].map((row) => row.querySelector('.text').textContent)",
    );
    let expected: Vec<&str> = [["waypoints"].repeat(n_systems), ["cut-offs"].repeat(n_systems)].concat();
    assert_eq!(kinds, serde_json::json!(expected));
    // No two lines are of one colour and the same dashes.
    let looks = reader.value(
        "[...document.querySelectorAll('.system .swatch path')].map((path) => \
         getComputedStyle(path).stroke + ' ' + path.getAttribute('stroke-dasharray'))",
    );
    let mut looks: Vec<String> = serde_json::from_value(looks).unwrap();
    looks.sort_unstable();
    looks.dedup();
    assert_eq!(looks.len(), n_systems, "{looks:?}");
    // A key is named where there is one.
    let keys = reader.value("[...document.querySelectorAll('.system kbd')].map((key) => key.textContent)");
    assert_eq!(keys, serde_json::json!(["1", "2", "3", "4", "5", "6", "7", "8", "9"]));
    reader.0.press("End").unwrap();
    reader.0.frame().unwrap();
    reader.0.screenshot(&folder().join("many-systems.png")).unwrap();
    reader.has_no_complaint();
}

fn on_a_desk(reader: &mut Reader, file: &Path) {
    reader.0.open(file, DESKTOP).unwrap();
    assert_eq!(reader.text("title"), "Fieldwalk demo");
    assert_eq!(reader.value("document.querySelectorAll('.walk').length"), 2);
    assert_eq!(reader.value("document.querySelectorAll('#rows tbody tr').length"), 3);
    reader.has_no_complaint();

    // The slider and the keys move the walker; so does the clock.
    let slide = "(() => { const time = document.getElementById('time'); time.value = 40; \
        time.dispatchEvent(new Event('input')); })()";
    for canvas in ["map", "timeline"] {
        reader.value("document.getElementById('time').focus()");
        reader.0.press("Home").unwrap();
        reader.changes(canvas, |reader| {
            reader.value(slide);
        });
    }
    assert_eq!(reader.time_s(), 40.0);
    assert!(reader.text("clock").starts_with("40.0 s of "), "{}", reader.text("clock"));
    reader.0.press("ArrowRight").unwrap();
    assert_eq!(reader.time_s(), 41.0);
    reader.0.press("ArrowLeft").unwrap();
    assert_eq!(reader.time_s(), 40.0);
    assert!(reader.text("now-2").contains("± "), "{}", reader.text("now-2"));
    let wait = "new Promise(done => setTimeout(done, 400))";
    reader.0.press(" ").unwrap();
    assert_eq!(reader.value("document.getElementById('play').getAttribute('aria-label')"), "Pause");
    reader.value(wait);
    reader.0.press(" ").unwrap();
    let paused_s = reader.time_s();
    assert!(paused_s > 40.0, "{paused_s}");
    reader.value(wait);
    assert_eq!(reader.time_s(), paused_s);

    // Systems and what is shown of them, by click and by key.
    for system in 0..3 {
        let row = format!("#system-{system}");
        reader.changes("map", |reader| reader.click(&row));
        reader.changes("timeline", |reader| reader.0.press(&(system + 1).to_string()).unwrap());
        assert_eq!(reader.value(&format!("document.querySelector('{row}').checked")), true);
    }
    reader.changes("curves", |reader| reader.click("#system-0"));
    reader.click("#system-0");
    for shown in ["truth", "radius68", "radius95", "particles", "whole", "routes"] {
        reader.changes("map", |reader| reader.click(&format!("#show-{shown}")));
        reader.click(&format!("#show-{shown}"));
    }

    // Every layer has a picture of its own, and so has none.
    let n_layers = reader.value("document.getElementById('layer').options.length").as_u64().unwrap();
    assert_eq!(n_layers, 9);
    let mut pictures = Vec::new();
    for _ in 0..n_layers {
        reader.0.press("l").unwrap();
        pictures.push(reader.pixels("map"));
    }
    pictures.sort_unstable();
    pictures.dedup();
    assert_eq!(pictures.len() as u64, n_layers);
    assert_eq!(reader.value("document.getElementById('layer').value"), "Strength");
    assert!(reader.text("legend-unit").contains("µT"));

    reader.0.screenshot(&folder().join("desktop-light.png")).unwrap();
    reader.changes("map", |reader| reader.click("#theme"));
    assert_eq!(reader.value("document.documentElement.dataset.theme"), "dark");
    reader.0.screenshot(&folder().join("desktop-dark.png")).unwrap();

    // Another walk begins at its beginning.
    reader.changes("map", |reader| reader.0.press("]").unwrap());
    assert_eq!(reader.value("document.querySelector('[aria-current]').dataset.walk"), "1");
    assert_eq!(reader.time_s(), 0.0);
    reader.0.press("?").unwrap();
    assert_eq!(reader.value("document.getElementById('help').open"), true);
    reader.has_no_complaint();
}

fn on_a_phone(reader: &mut Reader, file: &Path) {
    reader.0.open(file, PHONE).unwrap();
    assert_eq!(reader.value("document.documentElement.dataset.theme"), "dark");
    let is_too_wide = "document.documentElement.scrollWidth > document.documentElement.clientWidth";
    assert_eq!(reader.value(is_too_wide), false);

    // One finger moves the map, two zoom it, one on the time line moves through time.
    let [x, y] = reader.middle("map");
    reader.changes("map", |reader| {
        reader.0.touch("touchStart", &[[x, y]]).unwrap();
        reader.0.touch("touchMove", &[[x + 60.0, y + 30.0]]).unwrap();
        reader.0.touch("touchEnd", &[]).unwrap();
    });
    reader.changes("map", |reader| {
        reader.0.touch("touchStart", &[[x - 20.0, y], [x + 20.0, y]]).unwrap();
        reader.0.touch("touchMove", &[[x - 60.0, y], [x + 60.0, y]]).unwrap();
        reader.0.touch("touchEnd", &[]).unwrap();
    });
    let [x, y] = reader.middle("timeline");
    reader.0.touch("touchStart", &[[x, y]]).unwrap();
    reader.0.touch("touchEnd", &[]).unwrap();
    let half_s = 0.5 * reader.value("Number(document.getElementById('time').max)").as_f64().unwrap();
    assert!((reader.time_s() - half_s).abs() < 0.1 * half_s, "{} of {half_s}", reader.time_s());
    reader.click("#zoom-fit");
    reader.0.frame().unwrap();
    reader.0.screenshot(&folder().join("phone-dark.png")).unwrap();
    reader.click("#theme");
    reader.0.frame().unwrap();
    reader.0.screenshot(&folder().join("phone-light.png")).unwrap();
    reader.has_no_complaint();
}
