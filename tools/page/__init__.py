"""Checks of the page's JavaScript, and the pictures of it in the documents."""
