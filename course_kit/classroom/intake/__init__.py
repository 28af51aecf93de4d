"""What an instructor has downloaded: whose each file is, and which one is the submission; nobody by a guess."""
