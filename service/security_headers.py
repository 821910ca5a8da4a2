"""Headers that every answer carries unless it says otherwise, problems and crashes included."""

SECURITY_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    # JSON opened in a browser is a page too: it loads nothing, and nobody frames it.
    "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'",
    # No page of another origin embeds what is here as a script or a picture.
    "Cross-Origin-Resource-Policy": "same-origin",
    # Patients' data stay out of caches, whose owners are not the patient's doctors.
    "Cache-Control": "no-store",
}
