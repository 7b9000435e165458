//! Attacks on the app by other pages, other computers' names, and names of files.

use std::fs;

use crate::browser::{Running, app_on};

fn opened() -> (tempfile::TempDir, Running, String) {
    let place = tempfile::tempdir().unwrap();
    fs::create_dir(place.path().join("open")).unwrap();
    fs::write(place.path().join("secret.csv"), "time [s],x\n0,1\n1,2\n").unwrap();
    fs::write(place.path().join("open/run.csv"), "time [s],x\n0,1\n1,2\n").unwrap();
    let app = app_on(&place.path().join("open"));
    let cookie = app.enter();
    (place, app, cookie)
}

#[test]
fn exact_an_own_page_is_answered() {
    let (_place, app, cookie) = opened();
    let answer = app.ask(&cookie, "GET /api/state", "");
    assert_eq!(answer.status, 200);
    assert!(answer.text().contains("run.csv"), "{}", answer.text());
}

/// A name of the attacker that leads to this computer (DNS rebinding).
#[test]
fn exact_foreign_hosts_are_refused() {
    let (_place, app, cookie) = opened();
    let port = app.port;
    let foreign = [format!("evil.example:{port}"), "127.0.0.1".into(), "localhost".into(), format!("0.0.0.0:{port}")];
    for host in foreign {
        let answer = app.send("GET /api/state", &[&format!("host: {host}"), &cookie], "");
        assert_eq!(answer.status, 421, "{host}");
    }
    let two = [app.host(), "host: evil.example".to_owned()];
    assert_ne!(app.send("GET /api/state", &[&two[0], &two[1], &cookie], "").status, 200);
    assert_ne!(app.send("GET /api/state", &[&cookie], "").status, 200);
}

#[test]
fn exact_other_origins_are_refused() {
    let (_place, app, cookie) = opened();
    let port = app.port;
    let others = [
        "null".into(),
        "https://evil.example".into(),
        format!("https://127.0.0.1:{port}"),
        "http://127.0.0.1:1".to_owned(),
    ];
    for origin in others {
        let origin = format!("origin: {origin}");
        for first in ["GET /api/state", "POST /api/jobs", "PUT /api/text?file=new.toml"] {
            assert_eq!(app.send(first, &[&app.host(), &origin, &cookie], "").status, 403, "{first} {origin}");
        }
    }
}

#[test]
fn exact_a_write_without_origin_is_refused() {
    let (place, app, cookie) = opened();
    for first in ["POST /api/jobs", "PUT /api/text?file=new.toml", "DELETE /api/draft?file=new.toml"] {
        assert_eq!(app.send(first, &[&app.host(), &cookie], "x").status, 403, "{first}");
    }
    assert!(!place.path().join("open/new.toml").exists());
}

#[test]
fn exact_nobody_without_the_cookie_is_answered() {
    let (_place, app, cookie) = opened();
    let other = cookie.replace('=', "=0");
    for first in ["GET /", "GET /site/app.js", "GET /api/state", "GET /api/report?file=run.csv"] {
        assert_eq!(app.send(first, &[&app.host()], "").status, 401, "{first}");
        assert_eq!(app.send(first, &[&app.host(), &other], "").status, 401, "{first}");
    }
}

#[test]
fn exact_the_address_lets_in_once() {
    let (_place, app, cookie) = opened();
    let again = app.send(&format!("GET {}", app.entry), &[&app.host()], "");
    assert_eq!(again.status, 401);
    assert!(again.head("set-cookie").is_none());
    // The browser that is in may load the address again.
    assert_eq!(app.send(&format!("GET {}", app.entry), &[&app.host(), &cookie], "").status, 303);
    assert_eq!(app.send("GET /enter?token=", &[&app.host()], "").status, 401);
}

#[test]
fn exact_the_cookie_is_for_the_browser_alone() {
    let place = tempfile::tempdir().unwrap();
    let app = app_on(place.path());
    let answer = app.send(&format!("GET {}", app.entry), &[&app.host()], "");
    let cookie = answer.head("set-cookie").unwrap();
    assert!(cookie.contains("httponly") && cookie.contains("samesite=strict"), "{cookie}");
    assert!(cookie.starts_with(&format!("dynoid-{}=", app.port)), "{cookie}");
}

#[test]
fn exact_answers_forbid_scripts_of_others_and_frames() {
    let (_place, app, cookie) = opened();
    for first in ["GET /", "GET /api/state", "GET /nothing"] {
        let answer = app.ask(&cookie, first, "");
        let policy = answer.head("content-security-policy").unwrap();
        assert!(policy.contains("default-src 'none'") && policy.contains("frame-ancestors 'none'"), "{policy}");
        assert!(!policy.contains("unsafe"), "{policy}");
        assert_eq!(answer.head("x-content-type-options"), Some("nosniff"));
        assert_eq!(answer.head("cross-origin-resource-policy"), Some("same-origin"));
        assert_eq!(answer.head("cross-origin-opener-policy"), Some("same-origin"));
        assert!(answer.head("access-control-allow-origin").is_none());
    }
    assert_eq!(app.ask(&cookie, "OPTIONS /api/state", "").head("access-control-allow-origin"), None);
}

/// A report may have been written by anybody: it gets no origin, so that it can ask for nothing.
#[test]
fn exact_a_report_has_no_origin() {
    let (place, app, cookie) = opened();
    fs::write(place.path().join("open/report.html"), "<script>fetch('/api/state')</script>").unwrap();
    let answer = app.ask(&cookie, "GET /api/report?file=report.html", "");
    let policy = answer.head("content-security-policy").unwrap();
    assert!(policy.starts_with("sandbox") && !policy.contains("allow-same-origin"), "{policy}");
    assert!(!policy.contains("connect-src"), "{policy}");
}

#[test]
fn exact_files_outside_of_the_folder_are_refused() {
    let (place, app, cookie) = opened();
    let absolute = place.path().join("secret.csv").display().to_string();
    for name in ["../secret.csv", "%2e%2e/secret.csv", "x/../../secret.csv", absolute.as_str(), "C:%5Csecret.csv"] {
        for path in ["channels?file=", "text?file=", "report?file=", "draft?file=", "view?channels=%5B%22x%22%5D&file="]
        {
            let answer = app.ask(&cookie, &format!("GET /api/{path}{name}"), "");
            assert!([403, 404].contains(&answer.status), "{path}{name}: {}", answer.status);
            assert!(!answer.text().contains("time [s]"));
        }
        assert_eq!(app.ask(&cookie, &format!("PUT /api/text?file={name}"), "x").status, 403, "{name}");
        assert_eq!(app.ask(&cookie, &format!("POST /api/label?file={name}"), "").status, 403, "{name}");
        assert_eq!(app.ask(&cookie, &format!("POST /api/uses?file={name}"), "").status, 403, "{name}");
    }
    assert!(app.ask(&cookie, "GET /site/../Cargo.toml", "").status >= 400);
    assert!(app.ask(&cookie, "GET /site/%2e%2e/server.rs", "").status >= 400);
}

#[cfg(unix)]
#[test]
fn exact_links_out_of_the_folder_are_refused() {
    let (place, app, cookie) = opened();
    std::os::unix::fs::symlink(place.path().join("secret.csv"), place.path().join("open/link.csv")).unwrap();
    std::os::unix::fs::symlink(place.path(), place.path().join("open/up")).unwrap();
    for name in ["link.csv", "up/secret.csv"] {
        assert_eq!(app.ask(&cookie, &format!("GET /api/channels?file={name}"), "").status, 403, "{name}");
        assert_eq!(app.ask(&cookie, &format!("PUT /api/text?file={name}"), "x").status, 403, "{name}");
        let job = format!("{{\"arguments\":[\"inspect\",\"{name}\"]}}");
        assert_eq!(app.ask(&cookie, "POST /api/jobs", &job).status, 403, "{name}");
    }
    assert!(fs::read_to_string(place.path().join("secret.csv")).unwrap().contains("time"));
    assert!(!app.ask(&cookie, "GET /api/state", "").text().contains("secret"));
}

#[test]
fn exact_jobs_are_commands_within_the_folder() {
    let (_place, app, cookie) = opened();
    let refused = [
        r#"["app","--port","1"]"#,
        r#"["shell","manual"]"#,
        r#"["inspect","../secret.csv"]"#,
        r#"["inspect","/etc/passwd"]"#,
        r#"["study","bench.toml","--out=../elsewhere"]"#,
        r#"["study","bench.toml","--out","/tmp/elsewhere"]"#,
        r#"["study","bench.toml","-o/tmp/elsewhere"]"#,
        r#"["study","bench.toml","-qo../elsewhere"]"#,
        r#"["study","bench.toml","-o=/tmp/elsewhere"]"#,
        r#"[]"#,
        r#"["--overwrite"]"#,
    ];
    for arguments in refused {
        let answer = app.ask(&cookie, "POST /api/jobs", &format!("{{\"arguments\":{arguments}}}"));
        assert!([403, 422].contains(&answer.status), "{arguments}: {}", answer.status);
    }
    assert_eq!(app.ask(&cookie, "GET /api/jobs", "").text(), "[]");
    for id in ["..", "%2e%2e", "0/../..", "x"] {
        assert!(app.ask(&cookie, &format!("GET /api/jobs/{id}"), "").status >= 400, "{id}");
    }
}

/// A form of another page can send text, but no JSON.
#[test]
fn exact_a_form_starts_no_job() {
    let (_place, app, cookie) = opened();
    let body = r#"{"arguments":["inspect","run.csv"]}"#;
    let form = "content-type: text/plain";
    assert_eq!(app.send("POST /api/jobs", &[&app.host(), &app.origin(), &cookie, form], body).status, 415);
}
