"""What those are told who are not let in, and the page between the address with a token and the one without."""

from html import escape

VIEW_ONLY = (
    "this page is for viewing: it shows the saved work and changes nothing; to work on it, ask for the other address"
)
"""Said to whoever tries to change something on a view-only page."""

_STYLE = (
    "body{font:16px/1.5 system-ui,sans-serif;max-width:40em;margin:12vh auto;padding:0 1.5em;color:#1b1f24;"
    "background:#fff}h1{font-size:1.4em}code{background:#eef1f4;padding:.1em .3em;border-radius:3px}"
    "@media(prefers-color-scheme:dark){body{color:#e6e8eb;background:#16181b}code{background:#2a2e33}a{color:#8ab4f8}}"
)
_REFUSED = {
    "host": (
        "This server does not go by that name",
        "It was asked for as <code>{name}</code>. Open it by the address that it printed when it was started. Behind a "
        "reverse proxy, start it with <code>--public-address</code> and the address of the proxy.",
    ),
    "origin": (
        "Another site asked for this page",
        "What other sites ask for is refused, here for <code>{name}</code>. Open the page by the address that it "
        "printed when it was started. Behind a reverse proxy, start it with <code>--public-address</code> and the "
        "address of the proxy.",
    ),
    "view": (
        "Nothing is shared here",
        "This server was started without a view-only page. Whoever runs it can start it with "
        "<code>--share-view</code> and hand out the address that it prints then.",
    ),
}


def not_let_in_html(path: str, *, has_token: bool) -> str:
    """Return what is shown without the right token and without its cookie: how to get in."""
    wrong = "<p>The token in this address is not, or no longer, one of this server.</p>" if has_token else ""
    return _page_html(
        "stair_inspector opens with its whole address",
        f"{wrong}<p>Open the address that <code>stair-inspector view</code> printed in the terminal where it was "
        "started, with all that follows <code>token=</code>. This browser is then let in until it is closed.</p><ul>"
        "<li>The server was started again: it has a new token, so take the address that it has printed since. "
        "Saved work is there again.</li>"
        "<li>Somebody else started it: ask for the address.</li>"
        f'<li>You were in before and a link brought you here: <a href="{escape(path)}">open the page</a>.</li>'
        "<li>You come back to this each time: let this address keep cookies.</li></ul>",
    )


def refused_html(kind: str, name: str) -> str:
    """Return why a call was refused, of a ``kind`` of host, origin and view."""
    title, words = _REFUSED[kind]
    return _page_html(title, f"<p>{words.format(name=escape(name[:100]) or 'no name')}</p>")


def enter_html(target: str) -> str:
    """Return a page that goes on to the target by itself.

    A redirect would not do: a browser that followed a link from elsewhere would follow it without the new cookie.
    """
    link = escape(target)
    return _page_html(
        "You are let in",
        f'<p><a href="{link}">Open the page</a></p>',
        f'<meta http-equiv="refresh" content="0;url={link}">',
    )


def _page_html(title: str, body: str, head: str = "") -> str:
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{title}</title>{head}'
        '<meta name="viewport" content="width=device-width,initial-scale=1"><link rel="icon" href="data:,">'
        f"<style>{_STYLE}</style></head><body><h1>{title}</h1>{body}</body></html>"
    )
