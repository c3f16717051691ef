//! The exercises as a student meets them, in a folder of the test's own.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::{Duration, SystemTime};

use insta::assert_snapshot;
use tempfile::{TempDir, tempdir};

const FILE: &str = "work/chapter-1/src/e06_reflected_ray.rs";
const MAIN: &str = "work/chapter-1/src/main.rs";
const RIGHT: &str = "incident - 2.0 * n.dot(incident) * n";

/// A student who has an empty folder.
struct Student {
    folder: TempDir,
}

impl Student {
    fn new() -> Self {
        Self { folder: tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
        command
            .current_dir(&self.folder)
            .env("LANCER_WORK", "work")
            .arg("exercise")
            .args(arguments);
        command
    }

    fn output(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// What a command that succeeds prints.
    fn accepted(&self, arguments: &[&str]) -> String {
        let output = self.output(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        text(&output.stdout)
    }

    /// What a command that fails prints, however long it takes.
    fn failed(&self, arguments: &[&str]) -> String {
        let output = self.output(arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {}", text(&output.stderr));
        let said = text(&output.stdout) + &text(&output.stderr);
        said.lines()
            .filter(|line| {
                !["   Compiling", "    Finished", "    Blocking"]
                    .iter()
                    .any(|cargo| line.starts_with(cargo))
            })
            .fold(String::new(), |text, line| text + line + "\n")
    }

    /// Answers the exercise with one expression instead of `todo!()`.
    fn answer(&self, expression: &str) {
        let stub = stub();
        let start = stub.find("    todo!(").unwrap();
        self.write(FILE, &format!("{}    {expression}\n}}\n", &stub[..start]));
    }
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// The stub as it is handed out.
fn stub() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    fs::read_to_string(root.join("chapters/1-whitted/stubs/e06_reflected_ray.rs")).unwrap()
}

#[test]
fn before_anything_is_begun_there_is_no_folder() {
    let student = Student::new();
    let list = student.accepted(&["list"]);
    let line = list.lines().find(|line| line.contains("reflected-ray")).unwrap();
    assert!(line.contains("E1.6") && line.ends_with("10 min  new"), "{list}");
    assert_eq!(list.matches('→').count(), 1, "{list}");
    assert_snapshot!(student.failed(&["check"]), @"error: no exercise is begun; begin with: cargo xtask exercise start");
    assert_snapshot!(student.failed(&["show", "1.6"]), @"error: E1.6 reflected-ray: there is no file work/chapter-1/src/e06_reflected_ray.rs; make it with: cargo xtask exercise start reflected-ray");
    assert!(!student.path("work").exists());
}

#[test]
fn a_start_says_what_to_do_and_never_overwrites() {
    let student = Student::new();
    assert_snapshot!(student.accepted(&["start", "1.6"]), @r"
    E1.6 reflected-ray: The mirror ray (about 10 minutes)
      Slide    « Reflets spéculaires : calcul du rayon réfléchi »
      Lesson   chapters/1-whitted/README.md, « Reflets spéculaires : calcul du rayon
               réfléchi, du rayon réfracté (mirror and refracted rays) »
      Predict  the picture colours a ball by the direction in which it mirrors the
               eye's ray: what is the colour in its middle, and what at its rim?
      Write    reflected_ray in work/chapter-1/src/e06_reflected_ray.rs
      Then     cargo xtask exercise check reflected-ray, or watch reflected-ray
    ");
    assert_eq!(student.read(FILE), stub());
    for edited in ["mine", ""] {
        student.write(FILE, edited);
        let again = student.accepted(&["start", "reflected-ray"]);
        assert!(again.ends_with(&format!("Your file stays as it is: {FILE}\n")), "{again}");
        assert_eq!(student.read(FILE), edited);
    }
}

#[test]
fn a_new_stub_replaces_an_untouched_one_only() {
    let student = Student::new();
    student.accepted(&["start", "1.6"]);
    let begun_with = "work/.stubs/chapter-1/e06_reflected_ray.rs";
    for name in [FILE, begun_with] {
        student.write(name, "the stub of another version");
    }
    let renewed = student.accepted(&["start", "1.6"]);
    assert!(renewed.contains("Its stub is a new one"), "{renewed}");
    assert_eq!((student.read(FILE), student.read(begun_with)), (stub(), stub()));

    student.write(begun_with, "the stub of another version");
    student.write(FILE, "mine");
    let kept = student.accepted(&["start", "1.6"]);
    assert!(kept.contains("The course's stub has changed since you began"), "{kept}");
    assert!(kept.ends_with("compare\nchapters/1-whitted/stubs/e06_reflected_ray.rs\n"), "{kept}");
    assert_eq!(student.read(FILE), "mine");
}

#[test]
fn what_is_generated_is_made_again_and_the_students_files_stay() {
    let student = Student::new();
    student.accepted(&["start", "1.6"]);
    let generated =
        ["work/Cargo.toml", "work/chapter-1/Cargo.toml", MAIN, "work/.cargo/config.toml"];
    let before = generated.map(|name| student.read(name));
    student.write(FILE, "mine");
    for name in generated {
        student.write(name, "of an older version");
    }
    fs::remove_file(student.path("work/Cargo.lock")).unwrap();
    student.accepted(&["start", "1.6"]);
    assert_eq!(generated.map(|name| student.read(name)), before);
    assert!(student.path("work/Cargo.lock").exists());
    assert_eq!(student.read(FILE), "mine");
}

#[test]
fn a_reset_keeps_every_answer() {
    let student = Student::new();
    student.accepted(&["start", "1.6"]);
    for (answer, backup) in [("first", ".bak"), ("second", ".bak2"), ("third", ".bak3")] {
        student.write(FILE, answer);
        let said = student.accepted(&["reset", "1.6"]);
        assert!(said.ends_with(&format!("Your file is kept as {FILE}{backup}\n")), "{said}");
        assert_eq!(student.read(&format!("{FILE}{backup}")), answer);
        assert_eq!(student.read(FILE), stub());
    }
    student.accepted(&["reset", "1.6"]);
    assert!(!student.path(&format!("{FILE}.bak4")).exists());
}

#[test]
fn a_folder_that_cannot_be_used_is_one_error() {
    let student = Student::new();
    student.write("work", "a file");
    for arguments in [&["start"][..], &["list"], &["check"], &["watch"], &["reset", "1.6"]] {
        let said = student.failed(arguments).replace(&*student.folder.path().to_string_lossy(), "");
        assert_eq!(
            said,
            "error: /work is no folder, but your exercises need one of that name; move it away\n"
        );
    }
    assert_eq!(student.read("work"), "a file");

    let output =
        student.command(&["start", "1.6"]).env("LANCER_WORK", "work/below").output().unwrap();
    let error = text(&output.stderr);
    assert_eq!(error.lines().count(), 1, "{error}");
    assert!(error.starts_with("error: cannot make the folder "), "{error}");
}

#[test]
fn unknown_exercises_and_hints_are_refused() {
    let student = Student::new();
    for command in ["start", "check", "watch", "hint", "show", "solution", "reset"] {
        let said = student.failed(&[command, "reflektor"]);
        assert!(said.starts_with("error: unknown exercise `reflektor`; known: "), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
    for n in ["0", "4", "x"] {
        assert_eq!(student.output(&["hint", "1.6", "-n", n]).status.code(), Some(2), "{n}");
    }
}

#[test]
fn there_are_three_hints_and_an_answer() {
    let student = Student::new();
    assert_snapshot!(student.accepted(&["hint", "1.6"]), @r"
    E1.6 reflected-ray, hint 1 of 3: Split D into a part along N and a part along
    the surface. A mirror turns one of them around.
    More: cargo xtask exercise hint reflected-ray -n 2
    ");
    assert_snapshot!(student.accepted(&["hint", "1.6", "-n", "3"]), @r"
    E1.6 reflected-ray, hint 3 of 3: `n.dot(incident)` is N·D; take twice that many
    `n` away from `incident`.
    The answer: cargo xtask exercise solution reflected-ray
    ");
    let solution = student.accepted(&["solution", "1.6"]);
    let (answer, place) = solution.split_once("\nThe course's own code: ").unwrap();
    assert!(
        answer.starts_with("E1.6 reflected-ray: you have not begun this one\nOurs, a whole file")
    );
    assert!(answer.ends_with("\n    incident - 2.0 * n.dot(incident) * n\n}\n"), "{answer}");
    assert!(place.starts_with("crates/core/src/optics.rs:"), "{place}");
    assert!(place.contains(", `pub fn reflect`\nNotice: "), "{place}");
}

#[test]
fn every_proof_of_the_checks_holds() {
    let table = Student::new().accepted(&["verify"]);
    assert!(table.contains("\n   ● ○ ○  the factor 2 is missing: "), "{table}");
    assert!(!table.contains("FAILS"), "{table}");
}

/// Compiles the student's program, with what the tests have compiled already.
#[test]
fn a_student_goes_wrong_in_many_ways_and_then_right() {
    let student = Student::new();
    student.accepted(&["start", "1.6"]);
    assert_snapshot!(student.failed(&["check"]), @r"
    E1.6 reflected-ray: The mirror ray
      ✗ 45 degrees onto a floor
          still to be written: replace `todo!()` in e06_reflected_ray.rs
    ");
    assert!(student.accepted(&["list"]).contains("started"));

    student.answer("incident - n.dot(incident) * n");
    assert_snapshot!(student.failed(&["check", "1.6"]), @r"
    E1.6 reflected-ray: The mirror ray
      ✗ 45 degrees onto a floor
          case    incident (0.6, -0.8, 0) (towards the surface), N (0, 1, 0)
          got     (0.6, 0, 0)
          wanted  (0.6, 0.8, 0)

    This looks like a known slip: the factor 2 is missing: the vector is projected
    onto the surface, not mirrored
    ");
    assert!(student.accepted(&["list"]).contains("wrong"));
    assert!(student.failed(&["check", "--all"]).contains("✗ any plane, by hand"));

    student.answer("incident - 2 * n");
    let said = student.failed(&["check"]);
    let first = format!("E1.6 reflected-ray does not compile: {FILE}\n\nerror[E0277]: ");
    assert!(said.starts_with(&first), "{said}");
    assert!(said.contains(&format!("--> {FILE}:")), "{said}");
    assert!(!said.contains("main.rs"), "{said}");
    assert!(student.accepted(&["list"]).contains("not compiling"));

    let signature =
        "It should begin with:\n\n    pub fn reflected_ray(incident: DVec3, n: DVec3) -> DVec3\n";
    for (from, to, says) in [
        ("pub fn reflected_ray", "pub fn mirror", "has no function `reflected_ray`"),
        ("pub fn", "fn", "is private to that file"),
        ("n: DVec3", "n: f64", "takes or returns other types than it should"),
    ] {
        student.write(FILE, &stub().replace(from, to));
        let said = student.failed(&["check"]);
        let is_told = said.replace('\n', " ").contains(says);
        assert!(is_told && said.ends_with(signature), "{to}: {said}");
    }

    student.answer("reflected_ray(incident, n) * 2.0");
    assert_snapshot!(student.failed(&["check"]), @r"
    E1.6 reflected-ray: The mirror ray
      ✗ 45 degrees onto a floor
          your function called itself until the stack was full: does the recursion
          end?
    ");

    student.answer("let none: [DVec3; 0] = []; none[incident.length() as usize]");
    let said = student.failed(&["check"]);
    assert!(said.contains("your function panicked in line 12 of e06_reflected_ray.rs: "), "{said}");

    student.answer("std::process::exit(incident.length() as i32 - 1)");
    let said = student.failed(&["check"]);
    assert!(
        said.ends_with("Your program ended before its checks did: does it call `exit`?\n"),
        "{said}"
    );

    student.answer("let mut all = Vec::new(); loop { all.push([n; 1000]); }");
    let said = student.failed(&["check"]);
    assert!(said.contains("takes more than 2 GiB of memory"), "{said}");

    // The picture calls the function for each of its pixels.
    let other = "static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| drop(std::process::Command::new(\"sleep\").arg(\"30\").spawn()));";
    student.answer(&format!("{other} {RIGHT}"));
    let said = student.accepted(&["check"]);
    assert!(said.contains("A process that your program has started still runs."), "{said}");
    assert!(student.accepted(&["list"]).contains("passing"));

    // A file that is moved back comes with an old time.
    student.answer("incident - n.dot(incident) * n");
    let yesterday = SystemTime::now() - Duration::from_secs(86_400);
    let file = fs::File::options().append(true).open(student.path(FILE)).unwrap();
    file.set_modified(yesterday).unwrap();
    assert!(student.failed(&["check"]).contains("the factor 2 is missing"));

    student.answer(RIGHT);
    let said = student.accepted(&["check"]);
    let (report, next) = said.trim_end().rsplit_once('\n').unwrap();
    assert!(next.starts_with("Next: ") || next == "All exercises pass.", "{next}");
    assert_snapshot!(report, @r"
    E1.6 reflected-ray: The mirror ray
      ✓ 45 degrees onto a floor
      ✓ any plane, by hand
      ✓ the normal may stand on either side

    Right. See it: cargo xtask exercise show reflected-ray
    Then: turn N around in your function: why does the picture stay the same?
    Compare with ours: cargo xtask exercise solution reflected-ray
    ");
    assert!(student.accepted(&["list"]).contains("passing"));
    student.accepted(&["start", "1.7"]);
    let said = student.failed(&["check"]);
    assert!(said.starts_with("Right: E1.6\nE1.7 refracted-ray: "), "{said}");
    let shown = student.accepted(&["show", "1.6"]);
    assert!(
        shown
            .ends_with("Your picture is the reference's.\nThe plate is in work/figures/E1.6.png\n")
    );
    assert!(fs::read(student.path("work/figures/E1.6.png")).unwrap().starts_with(b"\x89PNG"));
    assert!(
        student
            .accepted(&["solution", "1.6"])
            .starts_with(&format!("E1.6 reflected-ray: yours is in {FILE}\n"))
    );

    fs::remove_file(student.path(FILE)).unwrap();
    let gone = student.failed(&["check", "1.6"]);
    assert!(gone.contains("make it with: cargo xtask exercise start reflected-ray"), "{gone}");
    watches(&student);
    #[cfg(unix)]
    takes_keys(&student);
}

/// A student who types single keys at a terminal.
#[cfg(unix)]
fn takes_keys(student: &Student) {
    use std::io::{BufRead, BufReader, Write};
    use std::process::Stdio;

    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

    let typist = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&typist).unwrap();
    unlockpt(&typist).unwrap();
    let terminal = ptsname(&typist, Vec::new()).unwrap().into_string().unwrap();
    let terminal = fs::File::options().read(true).write(true).open(terminal).unwrap();
    let mut child =
        student.command(&["watch", "1.6"]).stdin(terminal).stdout(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
    let mut lines = lines.inspect(|line| println!("{line}"));
    assert!(lines.any(|line| line.starts_with("Right.")));
    assert!(lines.any(|line| line.contains(" of 18 exercises done")));
    let mut typist = fs::File::from(typist);
    for (key, says) in [
        (b'h', "E1.6 reflected-ray, hint 1 of 3: "),
        (b'H', "E1.6 reflected-ray, hint 2 of 3: "),
        (b'l', "  E4.8 "),
        (b'o', "Notice: "),
        (b's', "Your picture is the reference's."),
        (b'c', "Right. "),
        (b'n', "E1.1 primary-ray: "),
    ] {
        typist.write_all(&[key]).unwrap();
        assert!(lines.any(|line| line.starts_with(says)), "{says}");
    }
    typist.write_all(b"q").unwrap();
    assert_eq!(lines.last().as_deref(), Some("The watch has ended."));
    assert!(child.wait().unwrap().success());
}

/// Follows a file without a terminal, from wrong to right, until it is interrupted.
fn watches(student: &Student) {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;

    student.accepted(&["start", "1.6"]);
    let mut child = student
        .command(&["watch", "1.6"])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
    let mut lines = lines.inspect(|line| println!("{line}"));
    assert!(lines.any(|line| line.contains("still to be written")));
    assert!(lines.any(|line| line.contains("waiting for a change")));
    student.answer(RIGHT);
    assert!(lines.any(|line| line.starts_with("Right.")));
    assert!(lines.any(|line| line.contains("waiting for a change")));
    // Editors and sync tools put a file back as another one, and with the time that it had.
    let (path, aside) = (student.path(FILE), student.path("aside"));
    fs::rename(&path, &aside).unwrap();
    std::thread::sleep(Duration::from_millis(500));
    student.answer("n");
    let old = fs::metadata(&aside).unwrap().modified().unwrap();
    fs::File::options().append(true).open(&path).unwrap().set_modified(old).unwrap();
    assert!(lines.any(|line| line.contains("✗ 45 degrees onto a floor")));
    assert!(lines.any(|line| line.contains("waiting for a change")));
    // One that stays away is missed, and waited for.
    fs::remove_file(&path).unwrap();
    assert!(lines.any(|line| line.contains("there is no file")));
    assert!(lines.any(|line| line.contains("waiting for a change")));
    fs::rename(&aside, &path).unwrap();
    assert!(lines.any(|line| line.starts_with("Right.")));
    assert!(lines.any(|line| line.contains("waiting for a change")));
    #[cfg(unix)]
    {
        let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        assert!(kill.success());
        assert_eq!(lines.last().as_deref(), Some("The watch has ended."));
        assert!(child.wait().unwrap().success());
    }
    #[cfg(not(unix))]
    child.kill().unwrap();
}

/// Otherwise the first check compiles the course once more.
#[test]
fn programs_and_tests_are_compiled_with_the_same_features() {
    let features = |arguments: &[&str]| -> BTreeSet<String> {
        let tree = Command::new(env!("CARGO"))
            .args(["tree", "--locked", "--prefix", "none", "--format", "{p} {f}"])
            .args(arguments)
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .output()
            .unwrap();
        assert!(tree.status.success(), "{}", text(&tree.stderr));
        text(&tree.stdout)
            .lines()
            .filter(|line| !line.is_empty())
            .map(|line| line.replace(" (*)", ""))
            .collect()
    };
    let tests = features(&["--workspace", "--edges", "normal,build,dev"]);
    let programs = features(&["--package", "xtask", "--edges", "normal,build"]);
    assert_eq!(programs.difference(&tests).collect::<Vec<_>>(), [""; 0]);
    let students =
        features(&["--package", "xtask", "--package", "lancer-student", "--edges", "normal,build"]);
    let of_student =
        |package: &&String| ["lancer-student ", "cap "].iter().any(|own| package.starts_with(own));
    let more = students.difference(&programs).filter(|package| !of_student(package));
    assert_eq!(more.collect::<Vec<_>>(), [""; 0]);
}
